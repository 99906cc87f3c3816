#include "skinning/motion_files/deepmimic_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/limits.h"
#include "skinning/motion_files/clip_times.h"

namespace ecorche::inline v1 {
namespace {

using Json = nlohmann::json;

constexpr double kFarthestMetre = 1e6;

Json parse_object(std::string_view text, const std::string& name) {
  Json out = Json::parse(text, nullptr, false);
  if (out.is_discarded() || !out.is_object())
    throw InputError(name + ": malformed JSON, or cut short");
  return out;
}

const Json& list_of(const Json& object, const char* key, const std::string& where) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array())
    throw InputError(fmt::format("{}: no list '{}'", where, key));
  return *found;
}

double number_of(const Json& object, const char* key, const std::string& where) {
  const auto found = object.find(key);
  const double value =
      found != object.end() && found->is_number() ? found->get<double>() : std::nan("");
  if (!(std::abs(value) <= kFarthestMetre))
    throw InputError(fmt::format("{}: {}: a number is missing or not finite", where, key));
  return value;
}

Vec3 vector_of(const Json& object, const std::string& key, const std::string& where) {
  Vec3 out;
  for (int k = 0; k < 3; ++k) out[k] = number_of(object, (key + "XYZ"[k]).c_str(), where);
  return out;
}

std::string name_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string()
             ? printable(found->get<std::string>().substr(0, limits::kNameBytes))
             : std::string();
}

class FrameReader {
 public:
  // `uneven` counts quaternions that are not of length 1.
  FrameReader(const Json& frame, std::string where, int& uneven)
      : frame_(frame), where_(std::move(where)), uneven_(uneven) {}

  double next() {
    const Json& value = frame_[at_++];
    const double out = value.is_number() ? value.get<double>() : std::nan("");
    if (!(std::abs(out) <= kFarthestMetre))
      throw InputError(fmt::format("{}: value {} is missing or not finite", where_, at_));
    return out;
  }

  Mat3 next_quaternion() {
    const double w = next(), x = next(), y = next(), z = next();
    const Quat q(w, x, y, z);
    if (!(q.norm() > 0.1 && q.norm() < 10))
      throw InputError(fmt::format("{}: values {} to {}: a quaternion (w x y z) of length {:.3g}",
                                   where_, at_ - 3, at_, q.norm()));
    if (std::abs(q.norm() - 1) > 0.01) ++uneven_;
    return q.normalized().toRotationMatrix();
  }

 private:
  const Json& frame_;
  std::string where_;
  int& uneven_;
  std::size_t at_ = 0;
};

// Where bones end that have no joint there: the far side of the body's shape, from its centre.
void add_ends(const Json& document, DeepMimicCharacter& out) {
  const auto bodies = document.find("BodyDefs");
  if (bodies == document.end() || !bodies->is_array()) return;
  std::set<int> parents;
  for (const ClipJoint& joint : out.joints) parents.insert(joint.parent);
  for (const Json& body : *bodies) {
    if (!body.is_object()) continue;
    const std::string name = name_of(body, "Name"), where = out.name + ": body '" + name + "'";
    for (std::size_t j = 0; j < out.joints.size(); ++j) {
      ClipJoint& joint = out.joints[j];
      if (joint.name != name || parents.contains(int(j))) continue;
      const Vec3 centre = vector_of(body, "Attach", where);
      const bool box = name_of(body, "Shape") == "box";
      const double reach = 0.5 * number_of(body, "Param0", where);
      if (box)
        joint.end_sites.emplace_back(centre.x() + reach, centre.y(), centre.z());
      else if (centre.norm() > 1e-6)
        joint.end_sites.push_back(centre + reach * centre.normalized());
    }
  }
}

}  // namespace

bool is_deepmimic(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '{' &&
         text.find("\"Frames\"") != std::string_view::npos;
}

DeepMimicCharacter parse_deepmimic_character(std::string_view text, const std::string& name) {
  const Json document = parse_object(text, name);
  const auto skeleton = document.find("Skeleton");
  if (skeleton == document.end() || !skeleton->is_object())
    throw InputError(name + ": no 'Skeleton'; expected a character file of DeepMimic");
  DeepMimicCharacter out;
  out.name = name;
  const Json& joints = list_of(*skeleton, "Joints", name + ": Skeleton");
  if (joints.empty() || joints.size() > limits::kMotionJoints)
    throw InputError(
        fmt::format("{}: {} joints; expected 1 to {}", name, joints.size(), limits::kMotionJoints));
  std::set<std::string> known;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const std::string where = fmt::format("{}: joint {}", name, j);
    if (!joints[j].is_object()) throw InputError(where + " is none");
    ClipJoint joint;
    joint.name = name_of(joints[j], "Name");
    if (joint.name.empty() || !known.insert(joint.name).second)
      throw InputError(fmt::format("{}: the name '{}' is empty or given twice", where, joint.name));
    const double parent = number_of(joints[j], "Parent", where);
    if (parent != std::floor(parent) || parent < (j == 0 ? -1 : 0) ||
        parent >= (j == 0 ? 0 : double(j)))
      throw InputError(fmt::format("{} '{}': parent {:g}; parents come before their children",
                                   where, joint.name, parent));
    joint.parent = int(parent);
    joint.offset = vector_of(joints[j], "Attach", where);
    if (!vector_of(joints[j], "AttachTheta", where).isZero(1e-9))
      throw UnfitError(fmt::format("{} '{}': it is turned at rest (AttachTheta), which is not read",
                                   where, joint.name));
    const std::string kind = name_of(joints[j], "Type");
    if (j > 0 && kind != "spherical" && kind != "revolute" && kind != "fixed")
      throw UnfitError(
          fmt::format("{} '{}': a joint of type '{}'; spherical, revolute and fixed ones are read",
                      where, joint.name, kind));
    out.values.push_back(j == 0 ? 7 : kind == "spherical" ? 4 : kind == "revolute" ? 1 : 0);
    out.joints.push_back(std::move(joint));
  }
  add_ends(document, out);
  return out;
}

MotionClip parse_deepmimic(std::string_view text, const std::string& name,
                           const DeepMimicCharacter& character, const std::optional<double>& fps) {
  const Json document = parse_object(text, name);
  const Json& frames = list_of(document, "Frames", name);
  if (frames.size() > std::size_t(limits::kMotionFrames))
    throw LimitError(
        fmt::format("{}: {} frames; the limit is {}", name, frames.size(), limits::kMotionFrames));
  MotionClip out;
  out.name = name;
  out.metres_per_unit = 1;
  out.joints = character.joints;
  out.joints[0].translation_track = out.translation_tracks++;
  std::size_t width = 1;
  for (std::size_t j = 0; j < out.joints.size(); ++j) {
    if (character.values[j] > 0) out.joints[j].rotation_track = out.rotation_tracks++;
    width += std::size_t(character.values[j]);
  }
  std::vector<double> times;
  double now = 0;
  int uneven = 0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const std::string where = fmt::format("{}: frame {}", name, f + 1);
    if (!frames[f].is_array() || frames[f].size() != width)
      throw InputError(
          fmt::format("{}: {} values; the {} joints of {} take {}; name the motion's "
                      "own character with --skeleton",
                      where, frames[f].size(), character.joints.size(), character.name, width));
    FrameReader values(frames[f], where, uneven);
    const double lasts = values.next();
    if (lasts < 0 || (lasts < 1e-5 && f + 1 < frames.size()) || lasts > 100)
      throw InputError(fmt::format("{}: it lasts {:g} s", where, lasts));
    times.push_back(now);
    now += lasts;
    Vec3 root;
    for (int k = 0; k < 3; ++k) root[k] = values.next();
    out.translations.push_back(root);
    for (std::size_t j = 0; j < out.joints.size(); ++j) {
      if (character.values[j] == 0) continue;
      out.rotations.push_back(
          character.values[j] == 1
              ? Eigen::AngleAxisd(values.next(), Vec3::UnitZ()).toRotationMatrix()
              : values.next_quaternion());
    }
  }
  out.frame_count = int(frames.size());
  if (uneven > 0)
    out.warnings.push_back(fmt::format(
        "{}: {} quaternions are not of length 1; their directions are taken", name, uneven));
  if (fps)
    out.fps = *fps;
  else
    set_times(times, out);
  return out;
}

}  // namespace ecorche::inline v1
