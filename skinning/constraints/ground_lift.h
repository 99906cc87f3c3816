// A figure that no leg and no arm keeps out of the ground is lifted as a whole.
#pragma once

#include <span>

#include "anatomy/skeleton.h"
#include "skinning/constraints/ground_heights.h"

namespace ecorche::inline v1 {

// Where a sole, or another part by `heights` of the motion (empty: soles alone), is deeper than 2
// mm under y = 0 the motion rises by its depth, 0.1 m at most, and begins to and comes down over
// 0.12 s (temporal_smoothing.h). Returns the largest rise, m.
double lift_from_ground(const Skeleton& skeleton, double sole_height,
                        std::span<const GroundHeights> heights, Motion& motion);

}  // namespace ecorche::inline v1
