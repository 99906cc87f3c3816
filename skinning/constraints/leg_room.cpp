#include "skinning/constraints/leg_room.h"

#include <algorithm>
#include <cmath>

#include "anatomy/joint_angles.h"
#include "skinning/constraints/leg_ik.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kMostFold = 0.25;       // m
constexpr double kLittle = 5 * kDegree;  // that an ankle is asked too much: limits give way to it

// By how much a joint is bent beyond its range, rad.
double beyond(const Joint& joint, const Quat& rotation) {
  return joint_angles(joint, rotation)[0] - joint.max[0];
}

}  // namespace

double fold_rise(const Skeleton& skeleton, const FootShape& foot, const Vec3& ankle, const Mat3& R,
                 Pose& pose, std::vector<Transform>& X) {
  constexpr double kTry = 0.02, kExact = 1e-4;  // m
  constexpr double kHelps = 1e-3;               // rad/m
  constexpr int kSteps = 4;
  const auto excess = [&](double rise) {
    reach_with_leg(skeleton, foot, ankle - Vec3(0, rise, 0), R, pose, X);
    return beyond(skeleton.joints[foot.hip], pose.rotations[foot.hip]);
  };
  double last = 0, before = excess(last);
  if (before <= 0) return 0;
  // Secants.
  double out = kTry;
  for (int step = 0; step < kSteps && std::abs(out - last) > kExact; ++step) {
    const double now = excess(out), slope = (now - before) / (out - last);
    if (slope > -kHelps) return step == 0 ? 0 : out;
    last = out;
    before = now;
    out = std::clamp(out - now / slope, 0.0, kMostFold);
  }
  return out;
}

double bent_rise(const Skeleton& skeleton, const FootShape& foot, const Vec3& ankle, const Mat3& R,
                 const Vec3& ball, Pose& pose, std::vector<Transform>& X) {
  const Vec3 along = R * (foot.ball - foot.heel).normalized();
  const auto excess = [&](double rise) {
    const Mat3 up = heel_up(along, rise);
    reach_with_leg(skeleton, foot, ball + up * (ankle - ball), up * R, pose, X);
    return beyond(skeleton.joints[foot.ankle], pose.rotations[foot.ankle]) - kLittle;
  };
  const double flat = excess(0);
  if (flat <= 0) return 0;
  // The shank leans further over a heel that rises: one secant.
  const double gained = flat - excess(flat);
  return flat * flat / std::max(0.5 * flat, gained);
}

Mat3 heel_up(const Vec3& along, double angle) {
  return Eigen::AngleAxisd(angle, Vec3::UnitY().cross(along).normalized()).toRotationMatrix();
}

double eased_reach(double far, double was, double length, double from) {
  const double room = std::max(1e-9, (kStraight - from) * length), over = far - from * length;
  if (over <= 0) return far;
  return std::max(std::min(far, was), from * length + room * (1 - std::exp(-over / room)));
}

}  // namespace ecorche::inline v1
