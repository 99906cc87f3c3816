#include "anatomy/skeleton.h"

#include <stdexcept>

namespace ecorche::inline v1 {

int find_joint(const Skeleton& skeleton, std::string_view name) {
  for (size_t j = 0; j < skeleton.joints.size(); ++j)
    if (skeleton.joints[j].name == name) return int(j);
  return -1;
}

std::vector<Vec3> rest_positions(const Skeleton& skeleton) {
  std::vector<Vec3> positions(skeleton.joints.size());
  for (size_t j = 0; j < positions.size(); ++j) {
    const Joint& joint = skeleton.joints[j];
    positions[j] = joint.X_PJ.translation();
    if (joint.parent >= 0) positions[j] += positions[joint.parent];
  }
  return positions;
}

Pose rest_pose(const Skeleton& skeleton) {
  Pose pose;
  if (!skeleton.joints.empty()) pose.root = skeleton.joints[0].X_PJ.translation();
  pose.rotations.assign(skeleton.joints.size(), Quat::Identity());
  return pose;
}

Transform joint_frame(const Skeleton& skeleton, const Pose& pose,
                      const std::vector<Transform>& X_WJ, std::size_t j) {
  const Joint& joint = skeleton.joints[j];
  const Mat3 turn = pose.rotations[j].toRotationMatrix();
  Transform out = Transform::Identity();
  if (joint.parent < 0) {
    out.linear() = turn;
    out.translation() = pose.root;
    return out;
  }
  const Transform& parent = X_WJ[std::size_t(joint.parent)];
  out.linear().noalias() = parent.linear() * turn;
  out.translation() = parent.linear() * joint.X_PJ.translation() + parent.translation();
  return out;
}

void forward_kinematics(const Skeleton& skeleton, const Pose& pose, std::vector<Transform>& out) {
  if (pose.rotations.size() != skeleton.joints.size())
    throw std::invalid_argument("forward_kinematics: " + std::to_string(pose.rotations.size()) +
                                " rotations for " + std::to_string(skeleton.joints.size()) +
                                " joints");
  out.resize(skeleton.joints.size());
  for (size_t j = 0; j < out.size(); ++j) out[j] = joint_frame(skeleton, pose, out, j);
}

void complete_pose(const Skeleton& skeleton, Pose& pose) {
  for (const char* side : {"_l", "_r"}) {
    const int knee = find_joint(skeleton, std::string("knee") + side);
    const int patella = find_joint(skeleton, std::string("patella") + side);
    if (knee < 0 || patella < 0) continue;
    const Vec3 axis = skeleton.joints[knee].axes.col(0);
    const Quat& q = pose.rotations[knee];
    // Twist of the knee's rotation about its flexion axis.
    const double angle = 2 * std::atan2(q.vec().dot(axis), q.w());
    const double wrapped = std::remainder(angle, 2 * 3.14159265358979323846);
    pose.rotations[patella] = Quat(Eigen::AngleAxisd(kPatellaShare * wrapped, axis));
  }
}

}  // namespace ecorche::inline v1
