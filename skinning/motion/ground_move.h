// Moves of a figure over level ground: turned about the vertical and shifted along it.
#pragma once

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// p -> R_y(yaw) p + shift; shift.y() is 0.
struct GroundMove {
  double yaw = 0;  // rad, from z towards x
  Vec3 shift = Vec3::Zero();

  Vec3 turned(const Vec3& p) const;
  Vec3 operator*(const Vec3& p) const { return turned(p) + shift; }
};

GroundMove operator*(const GroundMove& a, const GroundMove& b);  // b first
GroundMove inverse(const GroundMove& move);

// The part `share` of a move along its screw: power(m, a) * power(m, b) = power(m, a + b).
// Precondition: |yaw| below pi.
GroundMove power(const GroundMove& move, double share);

// Where the figure stands and faces: from the origin to below its root. The yaw is the root's
// rotation about the vertical.
GroundMove ground_place(const Pose& pose);

void move_pose(const GroundMove& move, Pose& pose);

// The pose that is `share` of the way from a to b; a at 0 and b at 1 to the bit.
Pose blend_poses(const Pose& a, const Pose& b, double share);

}  // namespace ecorche::inline v1
