// Division of the length of a strip's line between belly and tendon, as pose_anatomy() makes it.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/muscles/tendon_compliance.h"

namespace ecorche::inline v1 {

// Stretch of tendon over stretch of belly when the path changes.
inline constexpr double kTendonStretchRatio = 0.1;
// Bounds of the shortening that activation gives a belly: strain of its visible tendon (the
// aponeurosis within the belly strains, too, and is not counted), and share of the belly's length.
inline constexpr double kTendonLimit = 0.12;
inline constexpr double kShortLimit = 0.35;

// Rest lengths of one strip.
struct BellyRestLength {
  double rest = 0;        // length of the line, m
  double belly_rest = 0;  // of the belly, m; all of the line where a strip has no tendon
  TendonCompliance compliance;
};

// One a strip, in flat order.
std::vector<BellyRestLength> belly_rest_lengths(const Anatomy& anatomy);

// Length of the belly along the line, m; the rest is tendon. `length`: of the posed line;
// `activation` in [0, 1].
double belly_length(const BellyRestLength& rest_length, double length, double activation);

}  // namespace ecorche::inline v1
