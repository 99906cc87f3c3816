// The last step of growing muscles: what of their surface still stands out of the skin is moved
// inside.
//
// Sections that were grown or pressed one by one fit into their room; the surface that is drawn
// over them is more: caps past the ends, sheets between the strips, and places where the skin is
// not convex. Points of that surface outside the skin are found by rays from the middle of their
// section, which must not leave the skin on the way; their sections are pressed in until none is.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/queries/ray_caster.h"

namespace ecorche::inline v1 {

struct InsideReport {
  long long rays = 0;
  int outside = 0;  // surface points, before
  int left = 0;     // after
};

// `slices`: the sections of all muscles in order, which the strips hold already; both are changed.
// `suspects`: #muscles, those that come near the skin; the others are not looked at.
InsideReport pull_inside_skin(std::vector<Muscle>& muscles, std::span<Ellipse> slices,
                              std::span<const char> suspects, const SkinRays& rays);

}  // namespace ecorche::inline v1
