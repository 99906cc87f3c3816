// Knees, hands, elbows, trunk and head stay out of the ground, as feet do, also feet that joint
// limits have rolled.
//
// A figure that kneels, crawls, falls or lies comes down on parts whose flesh is as thick as this
// body's. Hands that would be in the ground are opened, they and elbows are raised by their arms,
// feet by legs that are bent, and for the rest the figure rises as a whole; feet that stand stay
// where they are. Corrections begin before they are needed and fade after it
// (temporal_smoothing.h).
#pragma once

#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/ground_heights.h"
#include "skinning/constraints/ground_points.h"
#include "skinning/constraints/joint_limits.h"

namespace ecorche::inline v1 {

// What a motion is corrected by, an entry a frame.
struct GroundClearance {
  std::vector<double> lift;        // of the whole figure, m
  std::vector<LimbShifts> shifts;  // of its arms, and of legs whose feet are too deep
};

// What takes a motion off the ground that is corrected by `clearance` and has these heights, where
// something is deeper than 2 mm; else it stays as it is. Too much is taken back. With `whole` arms
// give way no further and the figure rises for them, too. It rises by 0.2 m at most. Returns
// whether anything is too deep. Precondition: `clearance` is empty or of as many frames.
bool renew_clearance(const std::vector<GroundHeights>& heights, bool whole, double fps,
                     GroundClearance& clearance);

// Opens hands that are in the ground as far as it takes, within their limits: fingers become
// straight, then the wrist bends back. `heights`: of the motion. Returns whether any is.
bool open_hands(const Skeleton& skeleton, const GroundPoints& points,
                const std::vector<GroundHeights>& heights, Motion& motion);

}  // namespace ecorche::inline v1
