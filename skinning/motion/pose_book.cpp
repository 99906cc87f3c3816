#include "skinning/motion/pose_book.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>

#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/files/input_file.h"
#include "anatomy/joint_angles.h"
#include "skinning/motion/raise_arm.h"

namespace ecorche::inline v1 {
namespace {
struct Item {
  std::string part;
  std::vector<std::optional<double>> angles;  // rad; nothing: as at rest
};

class Poser {
 public:
  Poser(const Skeleton& skeleton, const std::string& where)
      : skeleton_(skeleton), where_(where), pose_(rest_pose(skeleton)) {}

  void apply(const Item& item) {
    const std::string& part = item.part;
    if (part == "trunk")
      return spread(item, {"l5", "l4", "l3", "l2", "l1", "t12", "t11", "thorax"});
    if (part == "neck") return spread(item, {"c7", "c6", "c5", "c4", "c3", "c2", "c1", "head"});
    if (find_joint(skeleton_, part) >= 0) return turn(part, item.angles);
    const bool sided = part.ends_with("_l") || part.ends_with("_r");
    const std::string stem = sided ? part.substr(0, part.size() - 2) : part;
    for (const std::string side : {"_l", "_r"}) {
      if (sided && !part.ends_with(side)) continue;
      if (stem == "arm")
        raise(item, side);
      else if (stem == "fingers")
        curl(item, side);
      else
        turn(stem + side, item.angles);
    }
  }
  Pose finish() {
    complete_pose(skeleton_, pose_);
    return pose_;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(fmt::format("{}: {}", where_, message));
  }

  int joint(const std::string& name) const {
    const int j = find_joint(skeleton_, name);
    if (j < 0) fail(fmt::format("'{}' is no joint or group; see docs/posebook.md", name));
    return j;
  }

  void turn(const std::string& name, const std::vector<std::optional<double>>& angles) {
    const int j = joint(name);
    const Joint& at = skeleton_.joints[j];
    Vec3 all = joint_angles(at, Quat::Identity());
    for (std::size_t k = 0; k < std::min<std::size_t>(3, angles.size()); ++k)
      if (angles[k]) all[k] = *angles[k];
    pose_.rotations[j] = joint_rotation(at, all);
  }

  void spread(const Item& item, const std::vector<std::string>& names) {
    for (std::size_t k = 0; k < std::min<std::size_t>(3, item.angles.size()); ++k)
      if (!item.angles[k])
        fail(fmt::format("'{}' needs numbers: it is counted from the rest pose", item.part));
    const auto reach = [&](const Joint& at, Eigen::Index k, double angle) {
      return std::abs(angle < 0 ? at.min[k] : at.max[k]);
    };
    for (const std::string& name : names) {
      const std::size_t j = joint(name);
      const Joint& at = skeleton_.joints[j];
      Vec3 share = Vec3::Zero();
      for (std::size_t k = 0; k < std::min<std::size_t>(3, item.angles.size()); ++k) {
        const Eigen::Index axis = k;
        double sum = 0;
        for (const std::string& other : names)
          sum += reach(skeleton_.joints[joint(other)], axis, *item.angles[k]);
        if (sum > 0) share[axis] = *item.angles[k] * reach(at, axis, *item.angles[k]) / sum;
      }
      pose_.rotations[j] = joint_rotation(at, joint_angles(at, Quat::Identity()) + share);
    }
  }

  void raise(const Item& item, const std::string& side) {
    if (item.angles.size() < 2 || !item.angles[0] || !item.angles[1])
      fail("an arm needs its elevation and the plane of it");
    for (const char* stem : {"clavicle", "scapula", "shoulder", "elbow"}) joint(stem + side);
    raise_arm(skeleton_, side == "_r" ? Side::right : Side::left,
              {*item.angles[0], *item.angles[1],
               item.angles.size() > 2 && item.angles[2] ? *item.angles[2] : 0},
              pose_);
  }

  void curl(const Item& item, const std::string& side) {
    if (item.angles.size() != 3)
      fail("fingers need three angles: of the joints next to the palm, in the middle, at the tips");
    constexpr std::array rows{"mcp", "pip", "dip"};
    for (std::size_t row = 0; row < 3; ++row)
      for (int finger = 2; finger <= 5; ++finger)
        turn(fmt::format("{}{}{}", rows[row], finger, side), {item.angles[row]});
  }

  const Skeleton& skeleton_;
  const std::string& where_;
  Pose pose_;
};

Item read_item(const std::string& text, const std::string& where) {
  std::istringstream words(text);
  Item item;
  words >> item.part;
  for (std::string word; words >> word;) {
    if (word == "-") {
      item.angles.emplace_back();
      continue;
    }
    std::istringstream digits(word);
    double degrees = 0;
    if (!(digits >> degrees) || !digits.eof() || !std::isfinite(degrees) || std::abs(degrees) > 360)
      throw InputError(fmt::format("{}: '{}' in '{}' is no angle in degrees", where, word, text));
    item.angles.emplace_back(degrees * kDegree);
  }
  if (item.angles.empty() || item.angles.size() > 3)
    throw InputError(fmt::format("{}: '{}' needs one to three angles", where, text));
  return item;
}

}  // namespace

Pose pose_of_angles(const std::string& angles, const Skeleton& skeleton, const std::string& where) {
  Poser poser(skeleton, where);
  std::istringstream items(angles);
  for (std::string text; std::getline(items, text, ';');)
    if (text.find_first_not_of(" \t") != std::string::npos) poser.apply(read_item(text, where));
  return poser.finish();
}

std::vector<NamedPose> read_pose_book(const std::filesystem::path& file, const Skeleton& skeleton) {
  return pose_book(Table(file), printable(file.string()), skeleton);
}

std::vector<NamedPose> pose_book(const Table& table, const std::string& name,
                                 const Skeleton& skeleton) {
  std::vector<NamedPose> out;
  std::set<std::string> names;
  for (int row = 0; row < table.rows(); ++row) {
    NamedPose each{table.text(row, "name"), table.text(row, "label"), table.text(row, "view"), {}};
    if (each.name.empty() || !names.insert(each.name).second)
      throw InputError(
          fmt::format("{}: the name '{}' is empty or comes twice", table.where(row), each.name));
    each.pose = pose_of_angles(table.text(row, "angles"), skeleton, table.where(row));
    out.push_back(std::move(each));
  }
  if (out.empty()) throw InputError(fmt::format("{}: holds no poses", name));
  return out;
}

}  // namespace ecorche::inline v1
