// Cuts an outline back by its penetration and keeps its area where it can. Private to contact and
// to muscle-skin collision.
#pragma once

#include "anatomy/contact/contact_table.h"

namespace ecorche::inline v1 {

// Least share of its area that a section keeps when it is cut back, 0 .. 1. Less: flattened
// sections whose belly swells elsewhere; more: overlap stays.
constexpr float kLeastArea = 0.3f;

// `penetration`: by direction, relative to the outline's factor. `blocked`: 0 free .. 1: where the
// outline does not regain lost area. The outline keeps at least the share `least` of its area.
void press_outline(const RadialSamples& penetration, const RadialSamples& blocked,
                   SliceOutline& outline, float least = kLeastArea);

}  // namespace ecorche::inline v1
