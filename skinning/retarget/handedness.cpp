#include "skinning/retarget/handedness.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace ecorche::inline v1 {
namespace {

constexpr int kMostFrames = 100;
constexpr double kAcross = 0.5;  // sine of the least angle between a bone and the hips' line
constexpr double kShare = 0.5;   // of what feet or knees tell, how much has to agree

// What many poses say of one question: the sum of signed votes, and of their sizes.
struct Votes {
  double sum = 0, size = 0;
  void add(double vote) {
    sum += vote;
    size += std::abs(vote);
  }
  // 1 yes, -1 no, 0 not told. `least`: of the sizes' sum.
  int answer(double least) const {
    if (size < least || std::abs(sum) < kShare * size) return 0;
    return sum > 0 ? 1 : -1;
  }
};

class Poses {
 public:
  Poses(const MotionClip& clip, const JointMapping& mapping) : clip_(clip), mapping_(mapping) {}

  void look_at(int frame) {
    clip_kinematics(clip_, frame, X_);
    const Vec3 left = at("hip_l") - at("hip_r");
    ++poses;
    for (const std::string s : {"_l", "_r"}) {
      const Vec3 thigh = at("knee" + s) - at("hip" + s), shin = at("ankle" + s) - at("knee" + s);
      const double leg = thigh.norm() + shin.norm();
      if (!(leg > 0)) continue;
      // A shin behind the thigh's line, and toes before the shin. What is in front of a bone is
      // told by the hips' line: the thigh of someone who sits looks up.
      if (const auto front = front_of(thigh, left)) knees.add(-front->dot(shin) / leg);
      const auto front = front_of(shin, left), toes = toes_of(s);
      if (front && toes) feet.add(front->dot(*toes) / leg);
    }
  }

  Votes feet, knees;
  int poses = 0;

 private:
  Vec3 at(const std::string& part) const {
    return X_[std::size_t(mapping_.position_joint.at(part))].translation();
  }
  static std::optional<Vec3> front_of(const Vec3& down, const Vec3& left) {
    const Vec3 front = down.cross(left);
    if (!(front.norm() > kAcross * down.norm() * left.norm())) return std::nullopt;
    return front.normalized();
  }
  std::optional<Vec3> toes_of(const std::string& s) const {
    for (const char* part : {"toes", "mtp3", "mtp2", "mtp1"})
      if (mapping_.position_joint.contains(part + s)) return at(part + s) - at("ankle" + s);
    Vec3 end;
    const int ankle = mapping_.rotation_joint.at("ankle" + s);
    if (!bone_end(clip_, ankle, end)) return std::nullopt;
    return Vec3(X_[std::size_t(ankle)].linear() * end);
  }

  const MotionClip& clip_;
  const JointMapping& mapping_;
  std::vector<Transform> X_;
};

}  // namespace

bool is_mirrored(const MotionClip& clip, const JointMapping& mapping) {
  constexpr double kFeet = 0.05, kKnees = 0.02;  // a pose and side, of the leg's length
  Poses poses(clip, mapping);
  if (clip.frame_count == 0) poses.look_at(-1);
  const int step = std::max(1, clip.frame_count / kMostFrames);
  for (int f = 0; f < clip.frame_count; f += step) poses.look_at(f);
  const int feet = poses.feet.answer(2 * kFeet * poses.poses),
            knees = poses.knees.answer(2 * kKnees * poses.poses);
  return feet + knees < 0;
}

MotionClip mirrored(MotionClip clip) {
  const auto flip = [](Vec3& v) { v.x() = -v.x(); };
  for (ClipJoint& joint : clip.joints) {
    flip(joint.offset);
    for (Vec3& end : joint.end_sites) flip(end);
  }
  for (Vec3& place : clip.translations) flip(place);
  for (Mat3& turn : clip.rotations) {
    turn.row(0) *= -1;
    turn.col(0) *= -1;
  }
  return clip;
}

}  // namespace ecorche::inline v1
