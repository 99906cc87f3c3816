// One frame of the file -> one pose of ours: rotations and the place of the hips, before feet and
// flights are looked after.
#pragma once

#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/retarget/joint_mapping.h"
#include "skinning/retarget/matching_rig.h"
#include "skinning/retarget/rest_alignment.h"

namespace ecorche {

class PoseTransfer {
 public:
  // The arguments are kept by reference. `own`: of a file whose rig sits in the body, else null.
  PoseTransfer(const BvhMotion& source, const SourceRig& rig, const RestAlignment& alignment,
               const OwnRig* own, const Skeleton& ours, bool shoulder_rhythm);

  double scale() const { return scale_; }  // file units -> metres of our figure

  // X: bvh_kinematics of the frame. `pose` gets rotations and a root with the file's own origin,
  // scaled.
  void transfer(const std::vector<Transform>& X, Pose& pose);

  // Where the file has its hip or its ankle: scaled, our axes.
  Vec3 hip_in_file(const std::vector<Transform>& X, Side side) const {
    return place_in_file(X, "hip", side);
  }
  Vec3 ankle_in_file(const std::vector<Transform>& X, Side side) const {
    return place_in_file(X, "ankle", side);
  }

  // World rotation of our joint's counterpart as the file has it. Precondition: the joint has one.
  Mat3 as_in_file(const std::vector<Transform>& X, const std::string& joint) const;

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
    double bending = 0,
           turning = 0;  // share of the way along spine or neck that has been bent, turned
    Quat relaxed = Quat::Identity();
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
  Mat3 turn_joint(const std::vector<Transform>& X, int joint) const;
  Vec3 place_in_file(const std::vector<Transform>& X, const char* part, Side side) const;
  bool has(const std::string& part) const { return alignment_.from_source.count(part) > 0; }
  int ours(const std::string& name) const;

  const BvhMotion& source_;
  const SourceRig& rig_;
  const RestAlignment& alignment_;
  const OwnRig* own_;
  const Skeleton& skeleton_;
  bool rhythm_;
  double scale_ = 1;
  std::vector<Vec3> rest_;
  std::vector<Plan> plans_;
  std::vector<Knot> spine_knots_, neck_knots_;
  std::map<std::string, Mat3>
      limb_;             // shoulder, hip: world rotations of this frame, hinges put right
  std::vector<Mat3> R_;  // world rotations of ours, this frame
  std::vector<Transform>
      X_WJ_;  // world frames of ours, this frame, where the rig is our body's own
};

}  // namespace ecorche
