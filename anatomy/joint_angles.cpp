#include "anatomy/joint_angles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "anatomy/joint_turn.h"

namespace ecorche::inline v1 {
namespace {

Vec3 angles_of(const Joint& joint, const Mat3& R) {
  if (!swings(joint))
    return {std::atan2(-R(1, 2), R(2, 2)), std::atan2(R(0, 2), std::hypot(R(0, 0), R(0, 1))),
            std::atan2(-R(0, 1), R(0, 0))};
  const Quat q(R);
  const double twist = std::remainder(2 * std::atan2(q.z(), q.w()), 2 * std::numbers::pi);
  const Quat swing = q * Quat(Eigen::AngleAxisd(-twist, Vec3::UnitZ()));
  const Vec3 v = swing.w() < 0 ? Vec3(-swing.vec()) : Vec3(swing.vec());
  const double half_sine = v.norm();
  const double scale =
      half_sine > 1e-12 ? 2 * std::atan2(half_sine, std::abs(swing.w())) / half_sine : 2;
  return {scale * v.x(), scale * v.y(), twist};
}

// How far angle a is beyond its limits.
double outside(const Joint& joint, int a, double angle) {
  return std::max({0.0, joint.min[a] - angle, angle - joint.max[a]});
}

double worst_excess(const Joint& joint, const Vec3& angles) {
  return std::max(
      {outside(joint, 0, angles[0]), outside(joint, 1, angles[1]), outside(joint, 2, angles[2])});
}

}  // namespace

Mat3 joint_zero(const Joint& joint) { return joint.axes * joint_turn(joint, joint.zero); }

Vec3 joint_angles(const Joint& joint, const Quat& rotation, const Mat3& zero) {
  return angles_of(joint, joint.axes.transpose() * rotation.toRotationMatrix() * zero);
}

Quat joint_rotation(const Joint& joint, const Vec3& angles, const Mat3& zero) {
  return Quat(Mat3(joint.axes * joint_turn(joint, angles) * zero.transpose()));
}

Vec3 joint_angles_near_limits(const Joint& joint, const Quat& rotation, const Mat3& zero) {
  constexpr double pi = std::numbers::pi;
  const Vec3 first = joint_angles(joint, rotation, zero);
  if (worst_excess(joint, first) == 0) return first;
  Vec3 other;
  if (!swings(joint)) {
    other = {first[0] + pi, pi - first[1], first[2] + pi};
  } else {  // the long way round
    const double angle = std::hypot(first[0], first[1]);
    const double scale = angle > 0 ? 1 - 2 * pi / angle : 1;
    other = {scale * first[0], scale * first[1], first[2]};
  }
  Vec3 best = first;
  double least = std::numeric_limits<double>::infinity();
  for (Vec3 angles : {first, other}) {
    for (int a = 0; a < 3; ++a) {
      if (swings(joint) && a < 2) continue;
      for (const double turn : {-2 * pi, 2 * pi})
        if (outside(joint, a, angles[a] + turn) < outside(joint, a, angles[a])) angles[a] += turn;
    }
    const double most = worst_excess(joint, angles);
    if (most < least) least = most, best = angles;
  }
  return best;
}

double limit_excess(const Joint& joint, const Quat& rotation, const Mat3& zero) {
  return worst_excess(joint, joint_angles_near_limits(joint, rotation, zero));
}

double limit_ease(const Joint& joint, int angle) {
  return std::min(3 * std::numbers::pi / 180, (joint.max[angle] - joint.min[angle]) / 10);
}

Quat clamped(const Joint& joint, const Quat& rotation, const Mat3& zero) {
  Vec3 angles = joint_angles_near_limits(joint, rotation, zero);
  const auto deep = [&](int a) {
    const double ease = limit_ease(joint, a);
    return angles[a] >= joint.min[a] + ease && angles[a] <= joint.max[a] - ease;
  };
  if (deep(0) && deep(1) && deep(2)) return rotation.w() < 0 ? Quat(-rotation.coeffs()) : rotation;
  for (int a = 0; a < 3; ++a) {
    const double room = joint.max[a] - joint.min[a], ease = limit_ease(joint, a);
    const double far = std::numbers::pi - room / 2;  // beyond one limit as beyond the other
    const double share =
        far > 0 ? std::clamp((outside(joint, a, angles[a]) / far - 0.5) / 0.5, 0.0, 1.0) : 0;
    const double high = joint.max[a] - ease, low = joint.min[a] + ease;
    if (ease > 0 && angles[a] > high)
      angles[a] = high + ease * std::tanh((angles[a] - high) / ease);
    if (ease > 0 && angles[a] < low) angles[a] = low + ease * std::tanh((angles[a] - low) / ease);
    angles[a] = std::clamp(angles[a], joint.min[a], joint.max[a]);
    angles[a] += share * share * (3 - 2 * share) * (joint.min[a] + room / 2 - angles[a]);
  }
  return joint_rotation(joint, angles, zero);
}

Vec3 joint_angles(const Joint& joint, const Quat& rotation) {
  return joint_angles(joint, rotation, joint_zero(joint));
}

Quat joint_rotation(const Joint& joint, const Vec3& angles) {
  return joint_rotation(joint, angles, joint_zero(joint));
}

Vec3 joint_angles_near_limits(const Joint& joint, const Quat& rotation) {
  return joint_angles_near_limits(joint, rotation, joint_zero(joint));
}

double limit_excess(const Joint& joint, const Quat& rotation) {
  return limit_excess(joint, rotation, joint_zero(joint));
}

Quat clamped(const Joint& joint, const Quat& rotation) {
  return clamped(joint, rotation, joint_zero(joint));
}

}  // namespace ecorche::inline v1
