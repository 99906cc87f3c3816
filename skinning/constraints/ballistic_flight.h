// In the air only gravity acts.
#pragma once

#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/retarget/retarget.h"

namespace ecorche {

// Finds the spans in which neither foot touches y = 0 and the centre of mass falls roughly freely,
// and moves the root so that it does so exactly: 9.81 m/s^2 down, steady speed, from the frame
// before to the frame after. Takes as long as before.
void keep_flights(const Skeleton& skeleton, double sole_height, Motion& motion,
                  RetargetReport& report);

}  // namespace ecorche
