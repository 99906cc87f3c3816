#include "skinning/leg_reach.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/joint_angles.h"

namespace ecorche {
namespace {

Quat twist_about(const Quat& q, const Vec3& axis) {
  const double along = q.vec().dot(axis);
  const Quat twist(q.w(), along * axis.x(), along * axis.y(), along * axis.z());
  return twist.norm() > 1e-12 ? twist.normalized() : Quat::Identity();
}

}  // namespace

double reach_with_leg(const Skeleton& skeleton, const FootShape& foot, const Vec3& ankle, const Mat3& foot_rotation, Pose& pose,
                      std::vector<Transform>& X) {
  const Vec3 hip = X[foot.hip].translation(), knee = X[foot.knee].translation();
  const Vec3 thigh = knee - hip, shank = X[foot.ankle].translation() - knee;
  const Vec3 wanted = ankle - hip;

  // |hip to ankle|^2 = |thigh|^2 + |shank|^2 + 2 (level + A cos d + B sin d) for a further flexion of d about the hinge:
  // greatest, the straight leg, at d = atan2(B, A); the knee that bends forwards lies beyond it.
  const Vec3 hinge = (X[foot.hip].linear() * skeleton.joints[foot.knee].axes.col(0)).normalized();
  const double level = thigh.dot(hinge) * shank.dot(hinge);
  const double A = thigh.dot(shank) - level, B = thigh.dot(hinge.cross(shank));
  const double amplitude = std::hypot(A, B);
  const double C = 0.5 * (wanted.squaredNorm() - thigh.squaredNorm() - shank.squaredNorm()) - level;
  const double flexion = std::atan2(B, A) + std::acos(std::clamp(C / amplitude, -1.0, 1.0));
  const Mat3 bend = Eigen::AngleAxisd(flexion, hinge).toRotationMatrix();
  const Vec3 reached = thigh + bend * shank;
  const Mat3 swing = Quat::FromTwoVectors(reached, wanted).toRotationMatrix();

  const Mat3 pelvis = X[skeleton.joints[foot.hip].parent].linear();
  X[foot.hip].linear() = swing * X[foot.hip].linear();
  X[foot.knee].linear() = swing * bend * X[foot.knee].linear();
  X[foot.knee].translation() = hip + swing * thigh;
  X[foot.ankle].translation() = hip + swing * reached;
  pose.rotations[foot.hip] = Quat(Mat3(pelvis.transpose() * X[foot.hip].linear())).normalized();
  pose.rotations[foot.knee] = Quat(Mat3(X[foot.hip].linear().transpose() * X[foot.knee].linear())).normalized();

  const Quat whole(Mat3(X[foot.knee].linear().transpose() * foot_rotation));
  pose.rotations[foot.ankle] = twist_about(whole, skeleton.joints[foot.ankle].axes.col(0).normalized());
  pose.rotations[foot.subtalar] = (pose.rotations[foot.ankle].conjugate() * whole).normalized();
  X[foot.ankle].linear() = X[foot.knee].linear() * pose.rotations[foot.ankle].toRotationMatrix();
  X[foot.subtalar].linear() = foot_rotation;
  X[foot.subtalar].translation() = X[foot.ankle] * skeleton.joints[foot.subtalar].X_PJ.translation();
  for (int mtp : foot.mtp) {
    X[mtp].translation() = X[foot.subtalar] * skeleton.joints[mtp].X_PJ.translation();
    X[mtp].linear() = foot_rotation * pose.rotations[mtp].toRotationMatrix();
  }
  return std::max(0.0, wanted.norm() - reached.norm());
}

void turn_shin_with_foot(const Skeleton& skeleton, const FootShape& foot, Pose& pose) {
  const Joint& knee = skeleton.joints[foot.knee];
  const Vec3 shin = skeleton.joints[foot.ankle].X_PJ.translation().normalized(), hinge = skeleton.joints[foot.ankle].axes.col(0);
  Quat whole = pose.rotations[foot.ankle] * pose.rotations[foot.subtalar];
  const Quat twist = twist_about(twist_about(whole, hinge).conjugate() * whole, shin);
  const double wanted = std::remainder(2 * std::atan2(twist.vec().dot(shin), twist.w()), 2 * std::numbers::pi);
  const double sense = knee.axes.col(2).dot(shin) < 0 ? -1 : 1, has = joint_angles(knee, pose.rotations[foot.knee])[2];
  const double room = std::clamp(has + sense * wanted, std::min(has, knee.min[2]), std::max(has, knee.max[2])) - has;
  const Quat turn(Eigen::AngleAxisd(sense * room, shin));
  pose.rotations[foot.knee] = (pose.rotations[foot.knee] * turn).normalized();
  whole = turn.conjugate() * whole;
  pose.rotations[foot.ankle] = twist_about(whole, hinge);
  pose.rotations[foot.subtalar] = (pose.rotations[foot.ankle].conjugate() * whole).normalized();
}

}  // namespace ecorche
