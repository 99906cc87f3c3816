#include "anatomy/joint_turn.h"

#include <cmath>
#include <numbers>

namespace ecorche::inline v1 {
namespace {

// Rodrigues' formula, and the left Jacobian of the exponential map.
TurnWithRates swing_turn(const Vec3& v) {
  const double square = v.squaredNorm(), angle = std::sqrt(square);
  const bool small = angle < 1e-4;
  const double a = small ? 1 - square / 6 : std::sin(angle) / angle,
               b = small ? 0.5 - square / 24 : (1 - std::cos(angle)) / square,
               c = small ? 1.0 / 6 - square / 120 : (1 - a) / square;
  Mat3 K;
  K << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  const Mat3 KK = K * K;
  return {Mat3::Identity() + a * K + b * KK, Mat3::Identity() + b * K + c * KK};
}

}  // namespace

bool swings(const Joint& joint) { return joint.max[1] > std::numbers::pi / 2 && joint.parent >= 0; }

Mat3 joint_turn(const Joint& joint, const Vec3& angles) {
  return joint_turn_with_rates(joint, angles).turn;
}

TurnWithRates joint_turn_with_rates(const Joint& joint, const Vec3& angles) {
  const double cz = std::cos(angles[2]), sz = std::sin(angles[2]);
  if (swings(joint)) {
    TurnWithRates out = swing_turn(Vec3(angles[0], angles[1], 0));
    Mat3 twist;
    twist << cz, -sz, 0, sz, cz, 0, 0, 0, 1;
    out.rates.col(2) = out.turn.col(2);
    out.turn *= twist;
    return out;
  }
  const double cx = std::cos(angles[0]), sx = std::sin(angles[0]), cy = std::cos(angles[1]),
               sy = std::sin(angles[1]);
  TurnWithRates out;
  out.turn << cy * cz, -cy * sz, sy,                             //
      cx * sz + sx * sy * cz, cx * cz - sx * sy * sz, -sx * cy,  //
      sx * sz - cx * sy * cz, sx * cz + cx * sy * sz, cx * cy;
  out.rates << 1, 0, sy, 0, cx, -sx * cy, 0, sx, cx * cy;
  return out;
}

}  // namespace ecorche::inline v1
