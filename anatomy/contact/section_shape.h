// Outlines as contact evaluates them. Private to contact.
#pragma once

#include "anatomy/contact/contact_table.h"

namespace ecorche::inline v1 {

// Shape of a section at rest. `sides`: bit 0, its sheet goes on at the low side of the width axis,
// bit 1, at the high side.
SectionShape section_shape(const SliceOutline& outline, int sides);

// Sets `out` to the shape of a section with another outline than at rest, by coarser sampling of
// its reach: each frame.
void update_section_shape(const SheetSides& sides, const SliceOutline& outline, SectionShape& out);

}  // namespace ecorche::inline v1
