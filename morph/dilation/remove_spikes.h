// Spikes of packed muscles taken back: points that stand out of the surface and do not in the
// muscles that these were made from.
//
// Rays find room between neighbours for one section that those beside it do not find. A section's
// outline draws back where a point that follows it stands out, until it does so no more; what
// lies in the surface is not filled, as something else lies there.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// `slices`: the sections of all muscles in order; their outlines shrink, the muscles stay as they
// are. `reference`: matched by index; a muscle with other sections is left as it is. `partners`: as
// for pack_muscles; those of mirrored muscles are left. Returns the points that stood out.
int remove_spikes(std::span<const Muscle> muscles, std::span<const Muscle> reference,
                  std::span<const int> partners, std::span<Ellipse> slices);

}  // namespace ecorche::inline v1
