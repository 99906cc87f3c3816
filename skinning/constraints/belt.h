// A treadmill under the feet: what stands on its belt moves backwards, all alike.
#pragma once

#include <array>
#include <span>

#include "skinning/constraints/foot_contacts.h"

namespace ecorche::inline v1 {

// The belt's velocity, m/s, from the velocities of points of feet while they are low: their median
// where it is faster than 0.6 m/s along the floor and half of them are within a fifth of it. Nought
// for a floor, or fewer than ten points.
Vec3 belt_velocity(std::span<const Vec3> low_points);

// The same from heels and balls of both feet; low: within 30 mm of the floor.
Vec3 belt_velocity(const std::array<FootPaths, 2>& feet, const Motion& motion);

// Sees a motion from the belt, where it is a floor: everything moves by -belt a second.
void move_by_belt(const Vec3& belt, Motion& motion);
void move_by_belt(const Vec3& belt, std::array<FootPaths, 2>& feet, Motion& motion);

}  // namespace ecorche::inline v1
