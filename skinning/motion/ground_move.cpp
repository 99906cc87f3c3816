#include "skinning/motion/ground_move.h"

#include <cmath>
#include <numbers>

namespace ecorche::inline v1 {

Vec3 GroundMove::turned(const Vec3& p) const {
  const double c = std::cos(yaw), s = std::sin(yaw);
  return {c * p.x() + s * p.z(), p.y(), c * p.z() - s * p.x()};
}

GroundMove operator*(const GroundMove& a, const GroundMove& b) {
  return {std::remainder(a.yaw + b.yaw, 2 * std::numbers::pi), a * b.shift};
}

GroundMove inverse(const GroundMove& move) {
  GroundMove out{-move.yaw, Vec3::Zero()};
  out.shift = out.turned(-move.shift);
  return out;
}

GroundMove power(const GroundMove& move, double share) {
  // A screw turns about a fixed point, with x and z as the complex number z + i x:
  // shift(t) = (exp(i t yaw) - 1) / (exp(i yaw) - 1) * shift(1).
  const double whole = move.yaw, part = share * move.yaw;
  GroundMove out{part, share * move.shift};
  if (std::abs(whole) < 1e-9) return out;
  const double ratio = std::sin(0.5 * part) / std::sin(0.5 * whole);
  out.shift = GroundMove{0.5 * (part - whole), Vec3::Zero()}.turned(ratio * move.shift);
  return out;
}

GroundMove ground_place(const Pose& pose) {
  const Quat& q = pose.rotations[0];
  return {2 * std::atan2(q.w() < 0 ? -q.y() : q.y(), std::abs(q.w())),
          Vec3(pose.root.x(), 0, pose.root.z())};
}

void move_pose(const GroundMove& move, Pose& pose) {
  pose.root = move * pose.root;
  pose.rotations[0] = Quat(Eigen::AngleAxisd(move.yaw, Vec3::UnitY())) * pose.rotations[0];
}

Pose blend_poses(const Pose& a, const Pose& b, double share) {
  if (share <= 0) return a;
  if (share >= 1) return b;
  Pose out;
  out.root = (1 - share) * a.root + share * b.root;
  out.rotations.reserve(a.rotations.size());
  for (std::size_t j = 0; j < a.rotations.size(); ++j)
    out.rotations.push_back(a.rotations[j].slerp(share, b.rotations[j]));
  return out;
}

}  // namespace ecorche::inline v1
