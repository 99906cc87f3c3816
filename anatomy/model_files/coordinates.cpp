#include "anatomy/model_files/coordinates.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

namespace ecorche::inline v1 {
namespace {

constexpr double kFixedSpan = 0.0785;  // rad: angles with less to go are fixed
constexpr std::array kAxes{"flexion", "abduction", "rotation"};

Mat3 turned(const Vec3& angles) {
  return (Eigen::AngleAxisd(angles[0], Vec3::UnitX()) *
          Eigen::AngleAxisd(angles[1], Vec3::UnitY()) * Eigen::AngleAxisd(angles[2], Vec3::UnitZ()))
      .toRotationMatrix();
}

// The triple of intrinsic turns about x, y, z that means R and is nearest to `near`.
Vec3 angles_of(const Mat3& R, const Vec3& near) {
  constexpr double pi = std::numbers::pi;
  const Vec3 first(std::atan2(-R(1, 2), R(2, 2)), std::atan2(R(0, 2), std::hypot(R(0, 0), R(0, 1))),
                   std::atan2(-R(0, 1), R(0, 0)));
  const auto next_to = [&](Vec3 angles) {
    for (int i = 0; i < 3; ++i) angles[i] = near[i] + std::remainder(angles[i] - near[i], 2 * pi);
    return angles;
  };
  const Vec3 one = next_to(first), other = next_to({first[0] + pi, pi - first[1], first[2] + pi});
  return (one - near).squaredNorm() <= (other - near).squaredNorm() ? one : other;
}

// Forward, up, right.
Mat3 root_axes() {
  Mat3 axes;
  axes << 0, 0, -1, 0, 1, 0, 1, 0, 0;
  return axes;
}

}  // namespace

Vec3 root_angles(const Quat& rotation, const Vec3& near) {
  const Mat3 axes = root_axes();
  return angles_of(axes.transpose() * rotation.toRotationMatrix() * axes, near);
}

Quat root_rotation(const Vec3& angles) {
  const Mat3 axes = root_axes();
  return Quat(Mat3(axes * turned(angles) * axes.transpose()));
}

std::vector<Coordinate> model_coordinates(const Skeleton& skeleton) {
  std::vector<Coordinate> out;
  for (int j = 0; j < int(skeleton.joints.size()); ++j) {
    const Joint& joint = skeleton.joints[j];
    for (int axis = 0; axis < 3; ++axis)
      if (joint.parent >= 0 && joint.max[axis] - joint.min[axis] > kFixedSpan)
        out.push_back({fmt::format("{}_{}", joint.name, kAxes[axis]), j, axis});
  }
  return out;
}

Vec3 turn_angles(const Joint& joint, const Quat& rotation, const Vec3& near) {
  return angles_of(
      joint.axes.transpose() * rotation.toRotationMatrix() * joint.axes * turned(joint.zero), near);
}

Quat turn_rotation(const Joint& joint, const Vec3& angles) {
  return Quat(
      Mat3(joint.axes * turned(angles) * turned(joint.zero).transpose() * joint.axes.transpose()));
}

}  // namespace ecorche::inline v1
