#include "skinning/lift/resting_pose.h"

#include <string>

#include "anatomy/joint_angles.h"
#include "skinning/lift/carried_skin.h"
#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {

void set_joint(const Skeleton& skeleton, const std::string& name, const Vec3& degrees, Pose& pose) {
  const int j = joint_of(skeleton, name);
  const Joint& joint = skeleton.joints[std::size_t(j)];
  pose.rotations[std::size_t(j)] = joint_rotation(joint, kDegree * degrees);
}

// Arms hang beside the trunk with the hands on the belly.
void fold_arms(const Skeleton& skeleton, Pose& pose) {
  for (const std::string s : {"_l", "_r"}) {
    set_joint(skeleton, "shoulder" + s, Vec3(14, 14, -62), pose);
    set_joint(skeleton, "elbow" + s, Vec3(82, 0, 0), pose);
  }
}

// The lowest vertex of the skin at height 0.
void put_down(const Patient& patient, Pose& pose) {
  complete_pose(patient.skeleton, pose);
  Points V;
  carried_skin(patient, pose, {}, V);
  pose.root.y() -= V.col(1).minCoeff();
}

}  // namespace

Pose lying_pose(const Patient& patient) {
  Pose pose = rest_pose(patient.skeleton);
  fold_arms(patient.skeleton, pose);
  pose.rotations[0] = Quat(Eigen::AngleAxisd(-std::numbers::pi / 2, Vec3::UnitX()));
  put_down(patient, pose);
  return pose;
}

Pose sitting_pose(const Patient& patient, double recline) {
  Pose pose = rest_pose(patient.skeleton);
  fold_arms(patient.skeleton, pose);
  for (const std::string s : {"_l", "_r"}) {
    set_joint(patient.skeleton, "hip" + s, Vec3(92 - recline, 4, 0), pose);
    set_joint(patient.skeleton, "knee" + s, Vec3(89, 0, 0), pose);
  }
  pose.rotations[0] = Quat(Eigen::AngleAxisd(-kDegree * recline, Vec3::UnitX()));
  put_down(patient, pose);
  return pose;
}

}  // namespace ecorche::inline v1
