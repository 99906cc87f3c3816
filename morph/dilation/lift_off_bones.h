// Muscles beside bones, never through them: what of their middle lies in bone is moved out.
//
// Sections are carried by the bones that a muscle's path rides on, and stretched with the flesh:
// other bones, and its own between two path points, may lie in the way. Sections whose centre, or
// what is between them, lies in bone are moved out within their planes; neighbours along the strip
// follow half as far. A tube's strip goes round each bone on one side, if it can on the one where
// it was carried to. A sheet goes round each bone on one side: the one on which the rest of it
// lies. What lies over a muscle that was lifted goes with it, so that layers keep their order.
#pragma once

#include <span>

#include "anatomy/anatomy.h"
#include "anatomy/queries/ray_caster.h"
#include "morph/dilation/bone_rays.h"

namespace ecorche::inline v1 {

// `slices`: the sections of all muscles in order; their centres are changed, not the strips, those
// of mirror images (`partners` as for pack_muscles) excepted. `carried`: as many, before the flesh
// was stretched. `skin`: closed; centres are not moved near to it. The same bytes at any number of
// threads.
void lift_off_bones(std::span<const Muscle> muscles, std::span<Ellipse> slices,
                    std::span<const Ellipse> carried, std::span<const int> partners,
                    const BoneRays& bones, const SkinRays& skin);

}  // namespace ecorche::inline v1
