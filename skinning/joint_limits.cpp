#include "skinning/joint_limits.h"

#include <cmath>

namespace ecorche {
namespace {

// Columns made orthonormal and right-handed, flexion axis kept; `sign` is -1 where the given axes are left-handed, as those of a
// mirrored side are: then the third angle counts the other way round.
Mat3 right_handed(const Mat3& axes, double& sign) {
  Mat3 A;
  A.col(0) = axes.col(0).normalized();
  A.col(1) = (axes.col(1) - axes.col(1).dot(A.col(0)) * A.col(0)).normalized();
  A.col(2) = A.col(0).cross(A.col(1));
  sign = A.col(2).dot(axes.col(2)) < 0 ? -1.0 : 1.0;
  return A;
}

Mat3 turned(const Vec3& angles) {
  return (Eigen::AngleAxisd(angles[0], Vec3::UnitX()) * Eigen::AngleAxisd(angles[1], Vec3::UnitY()) *
          Eigen::AngleAxisd(angles[2], Vec3::UnitZ()))
      .toRotationMatrix();
}

}  // namespace

Vec3 joint_angles(const Joint& joint, const Quat& rotation) {
  double sign = 1;
  const Mat3 A = right_handed(joint.axes, sign);
  const Vec3 flip(1, 1, sign);
  const Mat3 R = A.transpose() * rotation.toRotationMatrix() * A * turned(flip.cwiseProduct(joint.zero));
  const Vec3 angles(std::atan2(-R(1, 2), R(2, 2)), std::atan2(R(0, 2), std::hypot(R(0, 0), R(0, 1))),
                    std::atan2(-R(0, 1), R(0, 0)));
  return flip.cwiseProduct(angles);
}

Quat joint_rotation(const Joint& joint, const Vec3& angles) {
  double sign = 1;
  const Mat3 A = right_handed(joint.axes, sign);
  const Vec3 flip(1, 1, sign);
  return Quat(Mat3(A * turned(flip.cwiseProduct(angles)) * turned(flip.cwiseProduct(joint.zero)).transpose() * A.transpose()));
}

double limit_excess(const Joint& joint, const Quat& rotation) {
  const Vec3 angles = joint_angles(joint, rotation);
  return std::max({0.0, (joint.min - angles).maxCoeff(), (angles - joint.max).maxCoeff()});
}

Quat clamped(const Joint& joint, const Quat& rotation) {
  return joint_rotation(joint, joint_angles(joint, rotation).cwiseMax(joint.min).cwiseMin(joint.max));
}

}  // namespace ecorche
