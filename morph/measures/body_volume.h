// Stature and volume of a skin on the base mesh.
#pragma once

#include "anatomy/base_mesh/body_package.h"

namespace ecorche::inline v1 {

// Height of the skin above its lowest point, m.
double stature(const BodyPackage& package, const Points& points);

// Volume inside the skin with mouth and eye cavities closed off, m^3.
double skin_volume(const BodyPackage& package, const Points& points);

// Mass for the volume inside a skin: tissue of 1055 kg/m^3 less the air of half-filled lungs.
inline constexpr double kBodyDensity = 1010;  // kg/m^3

}  // namespace ecorche::inline v1
