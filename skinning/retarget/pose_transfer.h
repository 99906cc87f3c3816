// One frame of the file -> one pose of ours: rotations and root, before any constraint.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/retarget/joint_mapping.h"
#include "skinning/retarget/matching_rig.h"
#include "skinning/retarget/rest_alignment.h"

namespace ecorche::inline v1 {

class PoseTransfer {
 public:
  // The arguments are kept by reference. `matching_rig`: null for a file
  // whose rig does not match the body.
  PoseTransfer(const MotionClip& source, const JointMapping& mapping,
               const RestAlignment& alignment, const MatchingRig* matching_rig,
               const Skeleton& ours, bool shoulder_rhythm);

  double scale() const { return scale_; }  // file units -> metres of our figure

  // X: clip_kinematics of the frame. `pose` gets rotations and a root with the file's own origin,
  // scaled.
  void transfer(const std::vector<Transform>& X, Pose& pose);

  // Positions of the file's hip and ankle: scaled, our axes.
  Vec3 file_hip(const std::vector<Transform>& X, Side side) const {
    const SidePlan& here = sides_[side_index(side)];
    return file_place(X, here.hip, here.rig_hip);
  }
  Vec3 file_ankle(const std::vector<Transform>& X, Side side) const {
    const SidePlan& here = sides_[side_index(side)];
    return file_place(X, here.foot, here.rig_ankle);
  }

  // World rotation of our ankle's counterpart in the file.
  Mat3 file_ankle_rotation(const std::vector<Transform>& X, Side side) const {
    return sides_[side_index(side)].ankle.in(X);
  }

 private:
  enum class Rule {
    follow,
    direct,
    collar,
    spine,
    neck,
    clavicle,
    scapula,
    blade,
    elbow,
    forearm,
    ankle,
    subtalar,
    finger
  };
  // World rotation of one of our joints as the file has it.
  struct FileTurn {
    int joint = 0;  // the file's
    Mat3 before = Mat3::Identity(), after = Mat3::Identity();
    Mat3 in(const std::vector<Transform>& X) const {
      return before * X[std::size_t(joint)].linear() * after;
    }
  };
  struct Plan {
    Rule rule = Rule::follow;
    std::string part;  // whose rotation in the file
    FileTurn turn{};   // that rotation
    int limb = -1;     // or that of a limb's upper bone, into limbs_
    std::size_t side = 0;
    // fraction of bending and axial rotation of spine or neck up to here, from below
    double bending = 0, turning = 0;
    Quat relaxed = Quat::Identity();
    // of a joint that only goes with its parent: its turn on it, within its locked axes
    Mat3 still = Mat3::Identity();
  };
  struct Knot {
    double s = 0;
    FileTurn turn;
    Quat now = Quat::Identity();  // this frame
  };
  // Upper and lower bone of an arm or a leg.
  struct Limb {
    FileTurn upper, lower;
    Vec3 rest_upper = Vec3::Zero(), rest_lower = Vec3::Zero(), hinge = Vec3::Zero();
    Mat3 R = Mat3::Identity();  // of the upper bone, this frame, with a corrected hinge axis
  };
  struct SidePlan {
    FileTurn elbow, wrist, ankle;
    Vec3 arm = Vec3::Zero();                               // from the shoulder to the elbow at rest
    Vec3 scapula = Vec3::Zero(), wrist_at = Vec3::Zero();  // our joints at rest
    int hip = -1, foot = -1;  // joints of the file at our hip and ankle
    const MatchedPoint *rig_hip = nullptr, *rig_ankle = nullptr;
  };

  static std::size_t side_index(Side side) { return side == Side::right ? 1 : 0; }
  void plan_trunk();
  void plan_limbs();
  void plan_sides();
  FileTurn file_turn(const std::string& part) const;
  std::vector<Knot> knots(const std::string& from, const std::vector<int>& chain,
                          const std::string& to, bool from_base) const;
  Mat3 spread(const std::vector<Knot>& knots, const Plan& plan) const;
  void limb_rotations(const std::vector<Transform>& X);
  Mat3 rotate_joint(const std::vector<Transform>& X, int joint) const;
  Vec3 file_place(const std::vector<Transform>& X, int joint, const MatchedPoint* point) const;
  bool has(const std::string& part) const { return alignment_.from_source.count(part) > 0; }
  int ours(const std::string& name) const;

  const MotionClip& source_;
  const JointMapping& mapping_;
  const RestAlignment& alignment_;
  const MatchingRig* matching_rig_;
  const Skeleton& skeleton_;
  bool rhythm_;
  double scale_ = 1;
  std::vector<Vec3> rest_;
  std::vector<Plan> plans_;
  std::vector<Knot> spine_knots_, neck_knots_;
  std::array<Limb, 4> limbs_;  // arms, legs; left before right
  std::array<SidePlan, 2> sides_;
  std::vector<Mat3> zeros_;  // by joint: joint_zero()
  int thorax_ = -1;
  Vec3 hips_from_root_ = Vec3::Zero();  // middle of ours at rest
  std::vector<Mat3> R_;                 // world rotations of ours, this frame
  std::vector<Transform> X_WJ_;         // world frames of ours, this frame, with a matching rig
};

}  // namespace ecorche::inline v1
