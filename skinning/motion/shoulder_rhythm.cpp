#include "skinning/motion/shoulder_rhythm.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ecorche::inline v1 {
namespace {
// Thoracohumeral plane (0 abduction, 90 deg flexion) and elevation (0 hanging), with X pointing to
// the arm's own side.
struct ArmAngles {
  double plane = 0, elevation = 0;
};

ArmAngles arm_angles(const Vec3& arm) {
  const Vec3 a = arm.normalized();
  const double elevation = std::min(std::acos(std::clamp(-a.y(), -1.0, 1.0)), 150 * kDegree);
  // The plane means nothing for an arm that hangs or points straight up, and turns over behind the
  // body: faded out there.
  const double level = std::hypot(a.x(), a.z());
  return {
      level > 1e-9 ? level * std::clamp(std::atan2(a.z(), a.x()), -60 * kDegree, 130 * kDegree) : 0,
      elevation};
}

// Right-handed about the axes of a side whose X points outwards, in the order Y, Z, X: forwards,
// upwards, tilting back.
Quat girdle_rotation(double protraction, double elevation, double tilt) {
  return Quat(Eigen::AngleAxisd(-protraction, Vec3::UnitY()) *
              Eigen::AngleAxisd(elevation, Vec3::UnitZ()) *
              Eigen::AngleAxisd(-tilt, Vec3::UnitX()));
}

Quat mirrored(const Quat& q) { return Quat(q.w(), q.x(), -q.y(), -q.z()); }

}  // namespace

Girdle girdle_rhythm(Side side, const Vec3& arm_rest, const Vec3& arm) {
  // The right side is the left one mirrored in X; the left one has X outwards, Y up, Z forwards
  // already.
  const Vec3 outwards(side == Side::right ? -1 : 1, 1, 1);
  const ArmAngles rest = arm_angles(outwards.cwiseProduct(arm_rest)),
                  now = arm_angles(outwards.cwiseProduct(arm));
  const double plane = now.plane - rest.plane, elevation = now.elevation - rest.elevation;

  // Shoulder blade at rest: turned 33 deg forwards on the ribs, 3 deg up, 12 deg tilted forwards
  // (Ludewig 2009).
  constexpr double kForwards = 33 * kDegree, kUp = 3 * kDegree, kBack = -12 * kDegree;
  const Quat at_rest = girdle_rotation(kForwards, kUp, kBack);
  const Quat posed = girdle_rotation(kForwards + 0.140 * plane - 0.049 * elevation,
                                     kUp - 0.079 * plane + 0.396 * elevation,
                                     kBack - 0.028 * plane + 0.184 * elevation);
  Girdle out;
  out.clavicle =
      girdle_rotation(0.120 * plane - 0.242 * elevation, -0.046 * plane + 0.123 * elevation, 0);
  out.scapula = posed * at_rest.conjugate();
  if (side == Side::right)
    out.clavicle = mirrored(out.clavicle), out.scapula = mirrored(out.scapula);
  return out;
}

}  // namespace ecorche::inline v1
