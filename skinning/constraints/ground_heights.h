// How high the parts of a posed figure are over the ground.
#pragma once

#include <array>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/ground_points.h"

namespace ecorche::inline v1 {

// Height of the lowest of these points over y = 0, m. Beyond 0.3 m it may be more. `X_WJ`: frames
// of their joints at least.
double height_over_ground(const std::vector<GroundPatch>& patches,
                          const std::vector<Transform>& X_WJ);

// 1 for a foot whose sole looks down, 0 for one whose sole looks level or up, between them a smooth
// share. `foot`: its frame, whose y is up at rest.
double share_on_sole(const Transform& foot);

// Height of the lowest point of a pose's parts over y = 0, m. Beyond 0.3 m it may be more.
struct GroundHeights {
  double body = 0;
  std::array<double, 2> elbows{}, hands{};  // left, right; hands with their fingers
  std::array<double, 2> feet{};
  double least() const;  // of all but feet
  // From hip to ankle, of a leg's length: a leg that is stretched cannot raise its foot.
  std::array<double, 2> stretched{1, 1};
};

std::vector<GroundHeights> ground_heights(const Skeleton& skeleton, const GroundPoints& points,
                                          const Motion& motion);

// The joints that move these points, and all above them (joints_up_from()).
std::vector<int> joints_of(const Skeleton& skeleton,
                           const std::vector<const std::vector<GroundPatch>*>& patches);

}  // namespace ecorche::inline v1
