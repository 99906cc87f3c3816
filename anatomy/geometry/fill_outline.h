// Outlines in a plane as filled areas.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct FilledOutline {
  std::vector<Vec2> points;  // those of the outline, in order, then where its segments cross
  std::vector<std::array<int, 3>> triangles;  // counter-clockwise
};

// Fills what segments go around once or more often, in either direction: loops, loops within loops
// that turn the other way as holes, and loops that cross themselves or each other. Segments are
// pairs of indices into `points`, the inside on their left. A loop with gaps is closed from each
// open end to the nearest open beginning.
//
// Constrained Delaunay triangulation; a region is inside where its winding number (Jacobson,
// Kavan and Sorkine-Hornung 2013) is.
FilledOutline fill_outline(std::span<const Vec2> points,
                           std::span<const std::array<int, 2>> segments);

}  // namespace ecorche::inline v1
