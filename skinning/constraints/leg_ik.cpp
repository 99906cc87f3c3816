#include "skinning/constraints/leg_ik.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/joint_angles.h"

namespace ecorche::inline v1 {
namespace {

Quat twist_about(const Quat& q, const Vec3& axis) {
  const double along = q.vec().dot(axis);
  const Quat twist(q.w(), along * axis.x(), along * axis.y(), along * axis.z());
  return twist.norm() > 1e-12 ? twist.normalized() : Quat::Identity();
}

// Of a leg whose knee bends by a further d about its hinge: |hip to ankle|^2 = |thigh|^2 +
// |shank|^2 + 2 (level + A cos d + B sin d).
struct LegBend {
  Vec3 thigh, shank, hinge;
  double level, A, B;
  LegBend(const Skeleton& skeleton, const FootShape& foot, const std::vector<Transform>& X)
      : thigh(X[foot.knee].translation() - X[foot.hip].translation()),
        shank(X[foot.ankle].translation() - X[foot.knee].translation()),
        hinge((X[foot.hip].linear() * skeleton.joints[foot.knee].axes.col(0)).normalized()),
        level(thigh.dot(hinge) * shank.dot(hinge)),
        A(thigh.dot(shank) - level),
        B(thigh.dot(hinge.cross(shank))) {}
};

}  // namespace

double straight_leg(const Skeleton& skeleton, const FootShape& foot,
                    const std::vector<Transform>& X_WJ) {
  const LegBend leg(skeleton, foot, X_WJ);
  return std::sqrt(leg.thigh.squaredNorm() + leg.shank.squaredNorm() +
                   2 * (leg.level + std::hypot(leg.A, leg.B)));
}

double hip_drop(const Vec3& hip, const Vec3& ankle, double reach) {
  const double level = std::hypot(ankle.x() - hip.x(), ankle.z() - hip.z());
  if (level >= reach) return 0;
  return hip.y() - ankle.y() - std::sqrt(reach * reach - level * level);
}

double reach_with_leg(const Skeleton& skeleton, const FootShape& foot, const Vec3& ankle,
                      const Mat3& foot_rotation, Pose& pose, std::vector<Transform>& X) {
  const LegBend leg(skeleton, foot, X);
  const Vec3 hip = X[foot.hip].translation(), wanted = ankle - hip;
  const Vec3 &thigh = leg.thigh, &shank = leg.shank, &hinge = leg.hinge;
  // The straight leg, at d = atan2(B, A), is the longest; the knee that bends forwards lies beyond
  // it.
  const double amplitude = std::hypot(leg.A, leg.B);
  const double C =
      0.5 * (wanted.squaredNorm() - thigh.squaredNorm() - shank.squaredNorm()) - leg.level;
  const double flexion = std::atan2(leg.B, leg.A) + std::acos(std::clamp(C / amplitude, -1.0, 1.0));
  const Mat3 bend = Eigen::AngleAxisd(flexion, hinge).toRotationMatrix();
  const Vec3 reached = thigh + bend * shank;
  const Mat3 swing = Quat::FromTwoVectors(reached, wanted).toRotationMatrix();

  const Mat3 pelvis = X[skeleton.joints[foot.hip].parent].linear();
  X[foot.hip].linear() = swing * X[foot.hip].linear();
  X[foot.knee].linear() = swing * bend * X[foot.knee].linear();
  X[foot.knee].translation() = hip + swing * thigh;
  X[foot.ankle].translation() = hip + swing * reached;
  pose.rotations[foot.hip] = Quat(Mat3(pelvis.transpose() * X[foot.hip].linear())).normalized();
  pose.rotations[foot.knee] =
      Quat(Mat3(X[foot.hip].linear().transpose() * X[foot.knee].linear())).normalized();

  const Quat whole(Mat3(X[foot.knee].linear().transpose() * foot_rotation));
  pose.rotations[foot.ankle] =
      twist_about(whole, skeleton.joints[foot.ankle].axes.col(0).normalized());
  pose.rotations[foot.subtalar] = (pose.rotations[foot.ankle].conjugate() * whole).normalized();
  X[foot.ankle].linear() = X[foot.knee].linear() * pose.rotations[foot.ankle].toRotationMatrix();
  X[foot.subtalar].linear() = foot_rotation;
  X[foot.subtalar].translation() =
      X[foot.ankle] * skeleton.joints[foot.subtalar].X_PJ.translation();
  for (int mtp : foot.mtp) {
    X[mtp].translation() = X[foot.subtalar] * skeleton.joints[mtp].X_PJ.translation();
    X[mtp].linear() = foot_rotation * pose.rotations[mtp].toRotationMatrix();
  }
  return std::max(0.0, wanted.norm() - reached.norm());
}

void turn_shin_with_foot(const Skeleton& skeleton, const FootShape& foot, Pose& pose) {
  const Joint& knee = skeleton.joints[foot.knee];
  const Vec3 shin = skeleton.joints[foot.ankle].X_PJ.translation().normalized(),
             hinge = skeleton.joints[foot.ankle].axes.col(0);
  Quat whole = pose.rotations[foot.ankle] * pose.rotations[foot.subtalar];
  const Quat twist = twist_about(twist_about(whole, hinge).conjugate() * whole, shin);
  const double wanted =
      std::remainder(2 * std::atan2(twist.vec().dot(shin), twist.w()), 2 * std::numbers::pi);
  const double sense = knee.axes.col(2).dot(shin) < 0 ? -1 : 1,
               has = joint_angles(knee, pose.rotations[foot.knee])[2];
  const double room =
      std::clamp(has + sense * wanted, std::min(has, knee.min[2]), std::max(has, knee.max[2])) -
      has;
  const Quat turn(Eigen::AngleAxisd(sense * room, shin));
  pose.rotations[foot.knee] = (pose.rotations[foot.knee] * turn).normalized();
  whole = turn.conjugate() * whole;
  pose.rotations[foot.ankle] = twist_about(whole, hinge);
  pose.rotations[foot.subtalar] = (pose.rotations[foot.ankle].conjugate() * whole).normalized();
}

}  // namespace ecorche::inline v1
