// Vertices and triangles in spatial order, so that neighbours in space are neighbours in memory.
#pragma once

#include <vector>

#include "anatomy/geometry/subdivide.h"
#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Order along a Morton curve through the points' box: out[new] = old.
std::vector<int> spatial_order(const Points& V);

// Vertices renumbered by order[new] = old, triangles sorted by their lowest vertex.
Refinement reordered(const Refinement& refinement, const std::vector<int>& order);
TriMesh reordered(const TriMesh& mesh, const std::vector<int>& order);

}  // namespace ecorche::inline v1
