// By how much effort thickens a muscle's section while its joints hold still. Private to posing.
#pragma once

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// What full effort adds to a section's thickness, as a share of it, beside what gathers in
// mid-belly (activation_bulge.h); the width gives as much, so that the area stays. Where the
// muscle's tense thickness has been measured, the two together give that in mid-belly, but for what
// keeping the volume takes, and fade to nothing towards the ends. Other tubes turn rounder, other
// sheets do not change. `place`: -1 .. 1 along the belly.
double tense_thickening(const Muscle& muscle, const Ellipse& section, double place);

}  // namespace ecorche::inline v1
