#include "morph/placement/bone_groups.h"

#include <fmt/format.h>

#include <charconv>

#include <numbers>
#include <sstream>

#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kMillimetre = 1e-3;

std::vector<std::string> words(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> out;
  for (std::string word; in >> word;) out.push_back(word);
  return out;
}

Vec3 millimetres(const Table& table, int row, const std::string& prefix) {
  return kMillimetre * Vec3(table.number(row, prefix + "_x"), table.number(row, prefix + "_y"),
                            table.number(row, prefix + "_z"));
}

std::vector<GroupRule> read_groups(const Table& table) {
  std::vector<GroupRule> out;
  for (int row = 0; row < table.rows(); ++row) {
    GroupRule& rule = out.emplace_back();
    rule.name = table.text(row, "group");
    rule.paired = table.number(row, "paired") != 0;
    rule.bones = words(table.text(row, "bones"));
    rule.near = table.text(row, "near");
    rule.far = table.text(row, "far");
    rule.across = table.text(row, "across");
    rule.width = table.number(row, "width");
    rule.raised = table.number(row, "raised") * std::numbers::pi / 180;
    rule.shaft = table.number(row, "shaft") != 0;
    auto& free = rule.freedom;
    const auto percent = [&](const char* column) { return table.number(row, column) / 100; };
    const auto length = [&](const char* column) { return table.number(row, column) * kMillimetre; };
    free[BoneMap::shift_x] = free[BoneMap::shift_y] = free[BoneMap::shift_z] = length("shift");
    const double turn = table.number(row, "turn") * std::numbers::pi / 180;
    free[BoneMap::turn_x] = free[BoneMap::turn_y] = free[BoneMap::turn_z] = turn;
    free[BoneMap::log_length] = percent("length");
    free[BoneMap::log_width_x] = free[BoneMap::log_width_z] = percent("width_free");
    free[BoneMap::taper_x] = free[BoneMap::taper_z] = percent("taper");
    free[BoneMap::flare_x] = free[BoneMap::flare_z] = percent("flare");
    free[BoneMap::bow_x] = free[BoneMap::bow_z] = length("bow");
    free[BoneMap::shear_z] = length("shear");
    free[BoneMap::tuck_z] = length("tuck");
    free[BoneMap::tilt_near] = percent("tilt_near");
    free[BoneMap::tilt_far] = percent("tilt_far");
    if (!rule.paired)  // the middle stays its own mirror image
      for (const auto way : {BoneMap::shift_x, BoneMap::turn_y, BoneMap::turn_z, BoneMap::bow_x,
                             BoneMap::tilt_near, BoneMap::tilt_far})
        free[way] = 0;
  }
  return out;
}

int group_index(const FitRules& rules, const Table& table, int row, const char* column) {
  const std::string& name = table.text(row, column);
  for (size_t g = 0; g < rules.groups.size(); ++g)
    if (rules.groups[g].name == name) return int(g);
  throw InputError(fmt::format("{}: no group '{}' in bone_groups.csv", table.where(row), name));
}

}  // namespace

std::pair<std::string, Side> split_side(const std::string& name) {
  if (name.ends_with("_l")) return {name.substr(0, name.size() - 2), Side::left};
  if (name.ends_with("_r")) return {name.substr(0, name.size() - 2), Side::right};
  return {name, Side::middle};
}

FitRules read_fit_rules(const std::filesystem::path& folder) {
  FitRules rules;
  const Table groups(folder / "bone_groups.csv");
  rules.groups = read_groups(groups);
  for (size_t g = 0; g < rules.groups.size(); ++g)
    for (const std::string& bone : rules.groups[g].bones)
      if (!rules.group_of_bone.emplace(bone, int(g)).second)
        throw InputError(
            fmt::format("{}: bone '{}' is already in another group", groups.where(int(g)), bone));

  const Table contacts(folder / "bone_contacts.csv");
  for (int row = 0; row < contacts.rows(); ++row) {
    ContactRule& rule = rules.contacts.emplace_back();
    rule.point = contacts.text(row, "point");
    rule.a = group_index(rules, contacts, row, "a");
    rule.b = group_index(rules, contacts, row, "b");
    rule.tolerance = contacts.number(row, "tolerance") * kMillimetre;
    rule.along = contacts.text(row, "along");
    rule.spread = contacts.number(row, "spread") * kMillimetre;
    rule.loose = contacts.number(row, "loose") * kMillimetre;
    for (int k = 0; k < 3; ++k)
      rule.close[k] = contacts.number_or(row, std::string("close_") + "xyz"[k], 0) * kMillimetre;
  }

  const Table landmarks(folder / "palpable.csv");
  for (int row = 0; row < landmarks.rows(); ++row) {
    LandmarkRule& rule = rules.landmarks.emplace_back();
    rule.name = landmarks.text(row, "landmark");
    rule.bone = landmarks.text(row, "bone");
    rule.direction =
        Vec3(landmarks.number(row, "dx"), landmarks.number(row, "dy"), landmarks.number(row, "dz"))
            .normalized();
    for (int k = 0; k < 3; ++k) {
      const std::string axis(1, "xyz"[k]);
      rule.from[k] = landmarks.number_or(row, axis + "_from", 0);
      rule.to[k] = landmarks.number_or(row, axis + "_to", 1);
    }
    rule.low = landmarks.number(row, "low") * kMillimetre;
    rule.high = landmarks.number(row, "high") * kMillimetre;
    rule.tolerance = landmarks.number(row, "tolerance") * kMillimetre;
    rule.fat_site = landmarks.text(row, "fat_site");
    const std::string use = landmarks.text(row, "use");
    if (use != "fit" && use != "aim")
      throw InputError(fmt::format("{}: use '{}'; expected fit or aim", landmarks.where(row), use));
    rule.checked = use == "fit";
    if (!rules.group_of_bone.contains(rule.bone))
      throw InputError(
          fmt::format("{}: no group holds bone '{}'", landmarks.where(row), rule.bone));
  }

  const Table cubes(folder / "joint_cubes.csv");
  for (int row = 0; row < cubes.rows(); ++row) {
    CubeRule& rule = rules.cubes.emplace_back();
    rule.joint = cubes.text(row, "joint");
    rule.cube = cubes.text(row, "cube");
    rule.toward = cubes.text(row, "toward");
    constexpr std::string_view kVertex = "vertex-";
    if (rule.cube.starts_with(kVertex)) {
      const char* const end = rule.cube.data() + rule.cube.size();
      const auto read = std::from_chars(rule.cube.data() + kVertex.size(), end, rule.vertex);
      if (read.ec != std::errc() || read.ptr != end || rule.vertex < 0)
        throw InputError(
            fmt::format("{}: cube '{}'; expected vertex-NUMBER", cubes.where(row), rule.cube));
    }
    rule.male = millimetres(cubes, row, "male");
    rule.female = millimetres(cubes, row, "female");
    rule.tolerance = cubes.number(row, "tolerance") * kMillimetre;
  }
  return rules;
}

}  // namespace ecorche::inline v1
