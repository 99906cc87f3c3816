// Strips that turn aside and back after all that has moved their sections, brought towards their
// chords.
//
// Flesh that goes far (a big belly's wall over a pubis that stays) and bones that it is lifted off
// each bend a strip a little, and all of them together more than any limit of one.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// `slices`: the sections of all muscles in order; their centres move in their planes, those near
// the ends of strips stay. `reference`: matched by index; a muscle with other sections is left as
// it is. `partners`: as for pack_muscles; those of mirrored muscles are left. Returns the strips
// that were bent.
int straighten_strips(std::span<const Muscle> muscles, std::span<const Muscle> reference,
                      std::span<const int> partners, std::span<Ellipse> slices);

}  // namespace ecorche::inline v1
