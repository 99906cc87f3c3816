#include "skinning/motion_files/npz_motion.h"

#include <fmt/format.h>

#include <array>
#include <utility>
#include <vector>

#include "anatomy/errors.h"
#include "anatomy/files/zip_archive.h"
#include "anatomy/limits.h"
#include "skinning/motion_files/npy_read.h"

namespace ecorche::inline v1 {
namespace {

struct NamedJoint {
  const char* name;
  int parent;
  double x, y, z;  // from the parent, m, arms straight out; x to the left, z to the front
};

constexpr std::size_t kBody = 22;

// The order of joints is the models' convention; the lengths are those of our own average body.
constexpr std::array<NamedJoint, kBody> kBodyJoints = {{
    {"pelvis", -1, 0, 0, 0},
    {"left_hip", 0, 0.085, -0.03, 0},
    {"right_hip", 0, -0.085, -0.03, 0},
    {"spine1", 0, 0, 0.12, -0.01},
    {"left_knee", 1, 0, -0.42, 0},
    {"right_knee", 2, 0, -0.42, 0},
    {"spine2", 3, 0, 0.13, 0},
    {"left_ankle", 4, 0, -0.45, -0.01},
    {"right_ankle", 5, 0, -0.45, -0.01},
    {"spine3", 6, 0, 0.06, 0},
    {"left_toes", 7, 0.01, -0.05, 0.13},
    {"right_toes", 8, -0.01, -0.05, 0.13},
    {"neck", 9, 0, 0.21, -0.01},
    {"left_collar", 9, 0.03, 0.14, 0.01},
    {"right_collar", 9, -0.03, 0.14, 0.01},
    {"head", 12, 0, 0.11, 0.03},
    {"left_shoulder", 13, 0.15, 0, -0.02},
    {"right_shoulder", 14, -0.15, 0, -0.02},
    {"left_elbow", 16, 0.31, 0, 0},
    {"right_elbow", 17, -0.31, 0, 0},
    {"left_wrist", 18, 0.29, 0, 0},
    {"right_wrist", 19, -0.29, 0, 0},
}};

// Of the left hand; three joints a finger, each from the one before.
struct NamedFinger {
  const char* name;
  double x, y, z, next_x, next_z;
};
constexpr std::array<NamedFinger, 5> kFingers = {{
    {"index", 0.10, 0, 0.03, 0.035, 0},
    {"middle", 0.10, 0, 0.01, 0.04, 0},
    {"pinky", 0.085, 0, -0.035, 0.028, 0},
    {"ring", 0.095, 0, -0.012, 0.037, 0},
    {"thumb", 0.025, -0.01, 0.035, 0.03, 0.022},
}};

int add_joint(MotionClip& clip, std::string name, int parent, const Vec3& offset) {
  ClipJoint joint;
  joint.name = std::move(name);
  joint.parent = parent;
  joint.offset = offset;
  joint.rotation_track = clip.rotation_tracks++;
  clip.joints.push_back(std::move(joint));
  return int(clip.joints.size()) - 1;
}

int joint_named(const MotionClip& clip, const std::string& name) {
  for (std::size_t j = 0; j < clip.joints.size(); ++j)
    if (clip.joints[j].name == name) return int(j);
  return -1;
}

void add_hands(MotionClip& clip, bool with_fingers) {
  for (const double mirror : {1.0, -1.0}) {
    const std::string side = mirror > 0 ? "left_" : "right_";
    const int wrist = joint_named(clip, side + "wrist");
    if (!with_fingers) {
      add_joint(clip, side + "hand", wrist, {mirror * 0.09, 0, 0});
      continue;
    }
    for (const NamedFinger& finger : kFingers) {
      int parent = wrist;
      for (int k = 1; k <= 3; ++k)
        parent = add_joint(clip, fmt::format("{}{}{}", side, finger.name, k), parent,
                           k == 1 ? Vec3(mirror * finger.x, finger.y, finger.z)
                                  : Vec3(mirror * finger.next_x, 0, finger.next_z));
    }
  }
}

// The figure of a file with that many joints. Head, toes and hands end somewhere.
MotionClip figure_of(std::size_t joints, const std::string& name) {
  MotionClip out;
  out.name = name;
  out.metres_per_unit = 1;
  for (const NamedJoint& one : kBodyJoints)
    add_joint(out, one.name, one.parent, {one.x, one.y, one.z});
  if (joints == 55) {
    const int head = joint_named(out, "head");
    add_joint(out, "jaw", head, {0, 0, 0.03});
    add_joint(out, "left_eye", head, {0.03, 0.06, 0.07});
    add_joint(out, "right_eye", head, {-0.03, 0.06, 0.07});
  }
  if (joints > kBody) add_hands(out, joints > 24);
  if (out.joints.size() != joints)
    throw InputError(fmt::format(
        "{}: poses of {} joints; figures have 22, 24 (hands), 52 (fingers) or 55 (and a face)",
        name, joints));
  out.joints[0].translation_track = out.translation_tracks++;
  out.joints[std::size_t(joint_named(out, "head"))].end_sites.emplace_back(0, 0.2, 0.02);
  for (const double mirror : {1.0, -1.0}) {
    const std::string side = mirror > 0 ? "left_" : "right_";
    out.joints[std::size_t(joint_named(out, side + "toes"))].end_sites.emplace_back(0, -0.01, 0.06);
    if (joints == kBody)
      out.joints[std::size_t(joint_named(out, side + "wrist"))].end_sites.emplace_back(
          mirror * 0.18, 0, 0);
  }
  return out;
}

class Arrays {
 public:
  Arrays(std::string bytes, const std::string& name) : zip_(std::move(bytes), name), name_(name) {}

  bool has(const std::string& key) const { return zip_.contains(key + ".npy"); }
  NumberArray read(const std::string& key) const {
    constexpr std::size_t kMost = std::size_t{1} << 27;  // numbers
    return parse_npy(zip_.read(key + ".npy", limits::kMotionBytes), name_ + ": " + key, kMost);
  }
  // Rows of `size` numbers; 0: any.
  NumberArray rows(const std::string& key, std::size_t size) const {
    NumberArray out = read(key);
    if (out.shape.size() < 2 || out.rows() == 0 || out.row_size() % 3 != 0 ||
        (size > 0 && out.row_size() != size))
      throw InputError(fmt::format("{}: {}: {} rows of {} numbers; expected a row a frame of {}",
                                   name_, key, out.rows(), out.row_size(),
                                   size > 0 ? fmt::format("{}", size) : "three a joint"));
    return out;
  }
  std::string listed() const {
    std::string out;
    for (const std::string& one : zip_.names()) out += (out.empty() ? "" : ", ") + one;
    return out;
  }

 private:
  ZipArchive zip_;
  std::string name_;
};

// Columns of several arrays side by side.
NumberArray beside(const std::string& name, const std::vector<NumberArray>& parts) {
  NumberArray out;
  std::size_t width = 0;
  for (const NumberArray& part : parts) {
    width += part.row_size();
    if (part.rows() != parts[0].rows())
      throw InputError(fmt::format("{}: parts of poses have {} and {} frames", name,
                                   parts[0].rows(), part.rows()));
  }
  out.shape = {parts[0].rows(), width};
  for (std::size_t f = 0; f < out.rows(); ++f)
    for (const NumberArray& part : parts)
      for (std::size_t k = 0; k < part.row_size(); ++k)
        out.values.push_back(part.values[f * part.row_size() + k]);
  return out;
}

NumberArray poses_of(const Arrays& arrays, const std::string& name) {
  if (arrays.has("poses")) return arrays.rows("poses", 0);
  if (!arrays.has("root_orient") || !arrays.has("pose_body"))
    throw InputError(
        fmt::format("{}: neither 'poses' nor 'root_orient' and 'pose_body' among its arrays ({})",
                    name, arrays.listed()));
  std::vector<NumberArray> parts = {arrays.rows("root_orient", 3), arrays.rows("pose_body", 63)};
  if (arrays.has("pose_hand")) parts.push_back(arrays.rows("pose_hand", 90));
  return beside(name, parts);
}

double rate_of_file(const Arrays& arrays, const std::string& name) {
  for (const char* key : {"mocap_framerate", "mocap_frame_rate", "fps"}) {
    if (!arrays.has(key)) continue;
    const NumberArray rate = arrays.read(key);
    if (rate.values.size() == 1 && rate.values[0] >= 0.1 && rate.values[0] <= 10000)
      return rate.values[0];
    throw InputError(fmt::format("{}: {} is no rate; say it with --motion-fps", name, key));
  }
  throw InputError(name + ": no mocap_framerate; say it with --motion-fps");
}

}  // namespace

MotionClip parse_npz_motion(std::string bytes, const std::string& name,
                            const std::optional<double>& fps) {
  const Arrays arrays(std::move(bytes), name);
  const NumberArray poses = poses_of(arrays, name);
  if (poses.rows() > std::size_t(limits::kMotionFrames))
    throw LimitError(
        fmt::format("{}: {} frames; the limit is {}", name, poses.rows(), limits::kMotionFrames));
  MotionClip out = figure_of(poses.row_size() / 3, name);
  out.fps = fps ? *fps : rate_of_file(arrays, name);
  out.frame_count = int(poses.rows());
  for (std::size_t k = 0; k < poses.values.size(); k += 3) {
    const Vec3 turn(poses.values[k], poses.values[k + 1], poses.values[k + 2]);
    const double angle = turn.norm();
    if (angle > 1e4)
      throw InputError(fmt::format("{}: poses: row {}: a rotation of {:.3g} rad", name,
                                   k / poses.row_size() + 1, angle));
    out.rotations.push_back(angle < 1e-12
                                ? Mat3(Mat3::Identity())
                                : Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix());
  }
  if (!arrays.has("trans")) {
    out.translations.assign(poses.rows(), Vec3::Zero());
    out.warnings.push_back(name + ": no 'trans'; the root stays in its place");
    return out;
  }
  const NumberArray path = arrays.rows("trans", 3);
  if (path.rows() != poses.rows())
    throw InputError(
        fmt::format("{}: trans has {} frames, poses {}", name, path.rows(), poses.rows()));
  for (std::size_t f = 0; f < path.rows(); ++f)
    out.translations.emplace_back(path.values[3 * f], path.values[3 * f + 1],
                                  path.values[3 * f + 2]);
  return out;
}

}  // namespace ecorche::inline v1
