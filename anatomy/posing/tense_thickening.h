// Whither, and by how much, effort thickens a muscle's sections while its joints hold still.
// Private to posing.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// The directions in which a strip's sections thicken, in their axes, unit. Tubes: those in which
// their outlines are thin, evened along the strip; packing among neighbours has given them outlines
// that lie aslant in their axes. Sheets: their thickness, since their strips lie side by side.
std::vector<Vec2> thickening_directions(const Muscle& muscle, std::span<const Ellipse> sections);

// What full effort adds to a section's thickness in `direction`, as a share of it, beside what
// gathers in mid-belly (activation_bulge.h); the section gives as much across, so that the area
// stays. Where the muscle's tense thickness has been measured, the two together give that in
// mid-belly, but for what keeping the volume takes, and fade to nothing towards the ends. Other
// tubes turn rounder, other sheets do not change. `place`: -1 .. 1 along the belly.
double tense_thickening(const Muscle& muscle, const Ellipse& section, const Vec2& direction,
                        double place);

}  // namespace ecorche::inline v1
