// Bellies that no scale brings to their volume because of their outlines: sections that lean far to
// the inside of a bend lose volume as they are scaled up. Their outlines are made centrally
// symmetric as far as needed. Private to posing.
#pragma once

#include <span>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// Scaling of one strip: sections by 1 + belly (scale - 1), in thickness alone unless it is a tube.
struct BellyScaling {
  std::span<const float> belly;  // #sections
  bool tube = true;
  double low = 0, high = 0;  // of the scale
};

void scale_belly(std::span<Ellipse> strip, const BellyScaling& law, double scale);

// Scales sections so that they hold `volume` (tube_volume, m^3). Their outlines become as symmetric
// about their centres (a rotation by 180 deg maps them onto themselves) as that takes, and no more.
// Returns the scale. Where symmetric outlines do not help, the belly goes to the end of its range
// and all sections, tendons too, take up the rest. Continuous in the sections. A strip without
// belly stays as it is: 1. Precondition: two to kMaxStripSlices sections.
double symmetrize_outlines(std::span<Ellipse> strip, const BellyScaling& law, double volume);

}  // namespace ecorche::inline v1
