// Free flight: in the air only gravity acts on the centre of mass.
#pragma once

#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/motion_report.h"

namespace ecorche::inline v1 {

// Finds the spans in which neither foot touches y = 0 and the centre of mass falls roughly freely,
// and moves the root so that it follows a parabola exactly: `gravity` (m/s^2) down, constant
// horizontal velocity, from the frame before to the frame after. The duration is kept. What is
// hardly a fall is moved part of the way. Returns the spans that fall wholly. Other gravity
// than 9.81 is that of a motion in another time.
std::vector<Flight> make_flights_ballistic(const Skeleton& skeleton, double sole_height,
                                           double gravity, Motion& motion);

}  // namespace ecorche::inline v1
