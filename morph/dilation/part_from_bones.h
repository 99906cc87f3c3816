// Muscles beside bones, never through them: what of them still lies in bone is cut away.
//
// Once muscles have shared their room, lines from the middle of each strip to points of the drawn
// surface tell how much of a muscle bones take; those that cost least are cut short before the bone
// until that is little. See lift_off_bones.h for what comes first.
#pragma once

#include <span>

#include "anatomy/anatomy.h"
#include "morph/dilation/bone_rays.h"

namespace ecorche::inline v1 {

// `slices`: the sections of all muscles in order, as the strips hold them; their outlines are
// changed, not the strips, those of mirror images (`partners` as for pack_muscles) excepted. The
// same bytes at any number of threads.
void part_from_bones(std::span<const Muscle> muscles, std::span<Ellipse> slices,
                     std::span<const int> partners, const BoneRays& bones);

}  // namespace ecorche::inline v1
