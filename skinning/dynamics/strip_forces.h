// What the strips of muscles can pull at a length and a speed of their path: Hill's fibre in a row
// with its tendon (anatomy/muscles/force_curves.h).
#pragma once

#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// As exported models have them: strips share a muscle's largest force by their volumes; where no
// slack length is stated, the fibre has its optimal length at rest and the tendon is just slack.
struct StripForce {
  int muscle = 0;
  double share = 1;    // of the muscle
  double largest = 0;  // isometric, N; 0: pulls at nothing
  double fibre = 0;    // optimal, m
  double slack = 0;    // of the tendon, m
  double rise = 0;     // of the fibre across the path, over its optimal length
};

std::vector<StripForce> strip_forces(const Anatomy& anatomy);  // one a strip, in flat order

// Length of the fibre along the path over its optimal length, the tendon strained. Within what
// fibres can be.
double fibre_along(const StripForce& strip, double path, double strain);

// Pull along the path over the largest force.
struct Pull {
  double active = 0;   // at full effort
  double passive = 0;  // whatever the effort
};

// `along` of fibre_along(); `speed`: its change a second.
Pull pull_of(const StripForce& strip, double along, double speed);

}  // namespace ecorche::inline v1
