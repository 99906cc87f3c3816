#include "app/files/registration_hints.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/similar_names.h"
#include "skinning/motion_files/bvh_read.h"
#include "skinning/retarget/joint_names.h"

namespace ecorche {
namespace {

using nlohmann::json;

constexpr std::size_t kLandmarkFile = 1 << 20;  // bytes
constexpr std::size_t kFewestJoints = 6;

Vec3 place_of(const json& value, const std::string& file, const std::string& name) {
  const auto wrong = [&] {
    return InputError(
        fmt::format("{}: '{}': expected three finite numbers, [x, y, z]", file, name));
  };
  if (!value.is_array() || value.size() != 3) throw wrong();
  Vec3 out;
  for (int c = 0; c < 3; ++c) {
    if (!value[std::size_t(c)].is_number()) throw wrong();
    out[c] = value[std::size_t(c)].get<double>();
  }
  if (!out.allFinite()) throw wrong();
  return out;
}

}  // namespace

std::vector<Landmark> read_scan_landmarks(const std::filesystem::path& file,
                                          const std::vector<std::pair<std::string, int>>& known) {
  const std::string shown = printable(file.string());
  json root = json::parse(read_input_file(file, kLandmarkFile), nullptr, false);
  if (root.is_discarded())
    throw InputError(shown + ": not JSON; expected {\"acromion_l\": [x, y, z], ...}");
  if (root.is_object() && root.contains("landmarks")) root = json(root["landmarks"]);
  if (!root.is_object())
    throw InputError(shown + ": expected an object, {\"acromion_l\": [x, y, z], ...}");
  std::vector<std::string> names;
  for (const auto& [name, vertex] : known) names.push_back(name);
  std::vector<Landmark> out;
  for (const auto& [name, value] : root.items()) {
    const std::string words = printable(name);
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw UnfitError(
          fmt::format("{}: no landmark '{}'{}\nNames: those of data/body/landmarks.csv "
                      "with _l or _r (docs/scans.md)",
                      shown, words, did_you_mean(words, names)));
    out.push_back({name, place_of(value, shown, words)});
  }
  if (out.empty()) throw UnfitError(shown + ": holds no landmarks; leave --landmarks out");
  return out;
}

std::vector<Landmark> read_posed_joints(const std::filesystem::path& file) {
  const MotionClip clip = clip_from_bvh(read_bvh(file));
  std::vector<Transform> frames;
  clip_kinematics(clip, clip.frame_count > 0 ? 0 : -1, frames);
  // "LeftShoulder" is the collar bone where there is a "LeftArm" as well, and so for hips.
  std::map<std::string, Vec3> sure, maybe;
  for (std::size_t j = 0; j < clip.joints.size(); ++j) {
    NamedPart named = named_part(clip.joints[j].name);
    if (named.part.empty()) continue;
    const bool doubtful = named.part.ends_with("?");
    if (doubtful) named.part.pop_back();
    (doubtful ? maybe : sure)
        .emplace(named.part + side_suffix(named.side), frames[j].translation());
  }
  sure.merge(maybe);
  static const std::set<std::string> used{"hip",   "knee",  "ankle", "shoulder",
                                          "elbow", "wrist", "head"};
  std::vector<Landmark> out;
  for (const auto& [name, place] : sure)
    if (used.count(name.substr(0, name.find('_'))) && place.allFinite())
      out.push_back({name, place});
  if (out.size() < kFewestJoints)
    throw UnfitError(fmt::format(
        "{}: only {} of its joints are hips, knees, ankles, shoulders, elbows, wrists or a head by "
        "their names; registration needs {}",
        printable(file.string()), out.size(), kFewestJoints));
  return out;
}

}  // namespace ecorche
