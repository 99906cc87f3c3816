// Default sections for a muscle of which only the line and the forces are known.
#pragma once

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

struct StripForces {
  double volume = 0;        // m^3
  double fibre_length = 0;  // m
  double tendon_slack = 0;  // m
  double pennation = 0;     // rad
  double max_force = 0;     // N
};

// Gives a strip with a path its belly, tendons and slices, so that its tube has the volume. `deep`:
// from the belly's middle toward the bone that it lies on (thickness axis); zero where there is
// none.
void add_default_sections(Strip& strip, const StripForces& forces, const Vec3& deep);

}  // namespace ecorche::inline v1
