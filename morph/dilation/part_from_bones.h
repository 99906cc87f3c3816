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

// Of a muscle's volume, that may be left in bone: `ecorche check` asks for no more than 5 % along
// its own lines. Smaller: muscles that lie over many ribs or spines are cut away for what little
// of them is pierced.
inline constexpr double kLeftInBone = 0.012;

// `slices`: the sections of all muscles in order, as the strips hold them; their outlines are
// changed, not the strips, those of mirror images (`partners` as for pack_muscles) excepted.
// `allowed`: share of a muscle's volume that may be left in bone. The same bytes at any number of
// threads.
void part_from_bones(std::span<const Muscle> muscles, std::span<Ellipse> slices,
                     std::span<const int> partners, const BoneRays& bones,
                     double allowed = kLeftInBone);

}  // namespace ecorche::inline v1
