// The same shape in fewer triangles, for looking at.
#pragma once

#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Collapses edges in the order of the error that they make (Garland and Heckbert
// 1997, 10.1145/258734.258849) until at most `triangles` are left, or until no edge can go without
// folding the surface. Surfaces that meet in an edge or a corner are taken apart there; a mesh of
// no more triangles comes back as it is. Vertices that are left go to vertices that were there, so
// that what bulges never comes out farther. Precondition: F indexes V, V is finite.
TriMesh simplify(const TriMesh& mesh, int triangles);

// For each row of `from` the nearest row of `to`. Precondition: `to` has a row.
std::vector<int> nearest_rows(const Points& from, const Points& to);

}  // namespace ecorche::inline v1
