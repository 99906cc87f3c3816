// A motion over level ground put onto ground that rises.
#pragma once

#include "skinning/filters/filtered_motion.h"

namespace ecorche::inline v1 {

// Ground that rises by `angle` (rad) along the figure's way, or where it faces if it stays, through
// the ground below its first root. Feet turn with the ground, exactly, so that planted ones stay
// planted; the trunk stays upright and goes over the same place of the ground; the pelvis is
// lowered, smoothly, where a leg would be too short. Precondition: |angle| below 45 degrees.
void put_on_slope(const Skeleton& skeleton, double sole_height, double angle, Motion& motion);

// What turns level ground into that: a rotation about a point of both. For tests and pictures.
Transform slope_of(const Motion& level, double angle);

}  // namespace ecorche::inline v1
