// The path of a centre of mass that the ground can give: near to the one that was seen, smooth
// while feet stand, a parabola while none does.
//
// Derivatives of a smoothed path blur landings and take-offs over the time on both sides. Here the
// force per mass is u(t) g(t), with g what the contacts let through (0 in the air .. 1), and path
// and u are solved together: nearest to the seen path, u with the least fourth derivative of the
// path, as a smoothing spline whose knots know when feet stand.
#pragma once

#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct SupportedPath {
  std::vector<Vec3> place, acceleration;  // #frames, world
  double moved = 0;                       // m, the furthest from the seen path
};

// seen: #frames, m; contact: #frames, 0..1; cutoff: Hz, up to which u follows. Preconditions
// (std::invalid_argument): three frames or more, as many contacts, fps and cutoff above 0.
SupportedPath supported_path(const std::vector<Vec3>& seen, const std::vector<double>& contact,
                             double fps, double cutoff);

}  // namespace ecorche::inline v1
