// One frame of the file -> one pose of ours: rotations and root, before any constraint.
#pragma once

#include <map>
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
    return file_joint_position(X, "hip", side);
  }
  Vec3 file_ankle(const std::vector<Transform>& X, Side side) const {
    return file_joint_position(X, "ankle", side);
  }

  // World rotation of our joint's counterpart in the file. Precondition: the joint has one.
  Mat3 file_rotation(const std::vector<Transform>& X, const std::string& joint) const;

 private:
  enum class Rule {
    follow,
    direct,
    collar,
    spine,
    neck,
    clavicle,
    scapula,
    elbow,
    forearm,
    ankle,
    subtalar,
    finger
  };
  struct Plan {
    Rule rule = Rule::follow;
    std::string part;  // whose rotation in the file
    // fraction of bending and axial rotation of spine or neck up to here, from below
    double bending = 0, turning = 0;
    Quat relaxed = Quat::Identity();
    // of a joint that only goes with its parent: its turn on it, within its locked axes
    Mat3 still = Mat3::Identity();
  };
  struct Knot {
    double s = 0;
    std::string part;  // "pelvis", "thorax", "head", or empty: `joint`
    int joint = -1;
  };

  void plan_trunk();
  void plan_limbs();
  std::vector<Knot> knots(const std::string& from, const std::vector<int>& chain,
                          const std::string& to, bool from_base) const;
  Quat along(const std::vector<Transform>& X, const std::vector<Knot>& knots, double s) const;
  Mat3 spread(const std::vector<Transform>& X, const std::vector<Knot>& knots,
              const Plan& plan) const;
  void limb_rotations(const std::vector<Transform>& X);
  Mat3 rotate_joint(const std::vector<Transform>& X, int joint) const;
  Vec3 file_joint_position(const std::vector<Transform>& X, const char* part, Side side) const;
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
  // shoulder, hip: world rotations of this frame, with corrected hinge axes
  std::map<std::string, Mat3> limb_;
  std::vector<Mat3> R_;          // world rotations of ours, this frame
  std::vector<Transform> X_WJ_;  // world frames of ours, this frame, with a matching rig
};

}  // namespace ecorche::inline v1
