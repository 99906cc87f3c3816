// Where a string between two points runs when an object is in its way: via points that lift a
// muscle's line over what it wraps.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// Points of contact of the shortest string from a to b outside `wrap`, in order: none when the
// straight line is free or an end lies inside, one for a touch, three for an arc. `side` (object
// frame): where the string passes; zero: the nearer side. `clear`: how far off the surface they
// lie, m. World coordinates at rest. Found by relaxing a chain of points, to about a tenth of a
// millimetre.
std::vector<Vec3> taut_points(const Vec3& a, const Vec3& b, const Wrap& wrap, const Vec3& side,
                              double clear = 1e-3);

}  // namespace ecorche::inline v1
