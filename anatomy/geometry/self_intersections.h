// How much of a surface passes through itself.
#pragma once

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Triangles that cut another one with which they share no vertex, or overlap one with which they
// do, decided exactly. Throws UnfitError where three triangles meet at an edge, so that there is no
// surface. Precondition: indices within V, coordinates finite.
int count_self_intersections(const Triangles& F, const Points& V);

}  // namespace ecorche::inline v1
