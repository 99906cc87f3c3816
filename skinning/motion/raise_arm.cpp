#include "skinning/motion/raise_arm.h"

#include <cmath>
#include <string>

#include "skinning/motion/shoulder_rhythm.h"

namespace ecorche::inline v1 {
namespace {

struct ArmJoints {
  int clavicle = -1, scapula = -1, shoulder = -1, elbow = -1;
};

ArmJoints find_arm(const Skeleton& skeleton, Side side) {
  const auto joint = [&](const char* stem) {
    return find_joint(skeleton, std::string(stem) + side_suffix(side));
  };
  return {joint("clavicle"), joint("scapula"), joint("shoulder"), joint("elbow")};
}

}  // namespace

bool has_arm(const Skeleton& skeleton, Side side) {
  const ArmJoints arm = find_arm(skeleton, side);
  return arm.clavicle >= 0 && arm.scapula >= 0 && arm.shoulder >= 0 && arm.elbow >= 0;
}

void raise_arm(const Skeleton& skeleton, Side side, const ArmDirection& direction, Pose& pose) {
  const ArmJoints joints = find_arm(skeleton, side);
  const std::vector<Vec3> origins = rest_positions(skeleton);
  const Vec3 rest = (origins[joints.elbow] - origins[joints.shoulder]).normalized();
  const double out = side == Side::right ? -1 : 1;
  const Vec3 level(out * std::cos(direction.plane), 0, std::sin(direction.plane));
  const Vec3 axis = Vec3(-Vec3::UnitY()).cross(level);
  const Quat arm = Quat(Eigen::AngleAxisd(direction.elevation, axis.normalized())) *
                   Quat(Eigen::AngleAxisd(out * direction.outwards, Vec3::UnitY())) *
                   Quat::FromTwoVectors(rest, -Vec3::UnitY());
  const Girdle girdle = girdle_rhythm(side, rest, arm * rest);
  pose.rotations[joints.clavicle] = girdle.clavicle;
  pose.rotations[joints.scapula] = girdle.clavicle.conjugate() * girdle.scapula;
  pose.rotations[joints.shoulder] = girdle.scapula.conjugate() * arm;
}

}  // namespace ecorche::inline v1
