// Bellies whose outlines leave no growth that gives them their volume: sections that lean far
// towards the inside of a bend hold the less the more they swell. Private to posing.
#pragma once

#include <span>

#include "anatomy/anatomy.h"

namespace ecorche {

// How one strip grows: sections by 1 + belly (growth - 1), in thickness alone unless it is a tube.
struct BellyGrowth {
  std::span<const float> belly;  // #sections
  bool tube = true;
  double low = 0, high = 0;  // of the growth
};

void grow(std::span<Ellipse> strip, const BellyGrowth& law, double growth);

// Sections grow so that they hold `volume` (tube_volume, m^3). Their outlines become as even about
// their centres (half a turn maps them onto themselves) as it takes, and no more. Returns the
// growth. Where even outlines do not help, the belly goes to the end of its range and all sections,
// tendons too, take up what is left. Continuous in the sections. A strip without belly stays as it
// is: 1. Precondition: two to kMaxStripSlices sections.
double round_out(std::span<Ellipse> strip, const BellyGrowth& law, double volume);

}  // namespace ecorche
