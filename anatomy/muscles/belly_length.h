// How the length of a strip's line is shared out between belly and tendon, as pose_anatomy() does
// it.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/muscles/tendon_compliance.h"

namespace ecorche {

// stretch of tendon over stretch of belly, when the path changes
inline constexpr double kTendonGive = 0.1;

// Made once a strip.
struct BellyShare {
  double rest = 0;        // length of the line, m
  double belly_rest = 0;  // of it, m; all of it where a strip has no tendon
  TendonGive give;
};

// One a strip, in flat order.
std::vector<BellyShare> belly_shares(const Anatomy& anatomy);

// Length of the belly along the line, m; the rest is tendon. `length`: of the posed line;
// `activation` in [0, 1].
double belly_length(const BellyShare& share, double length, double activation);

}  // namespace ecorche
