// Where bones lie bare of muscle, the layer of skin and fat reaches down to them.
//
// data/bare.csv names the bones, near which joint, how deep under the skin, and how nearly parallel
// to it.
#pragma once

#include "anatomy/anatomy.h"
#include "anatomy/queries/ray_caster.h"
#include "morph/fat/fat_layer.h"

namespace ecorche {

// Deepens `layer`, which is of the skin of `rays`, to the bare faces of the bones of `anatomy`;
// nowhere makes it thinner. Bones and joints that the anatomy lacks are left out. Throws InputError
// when data/bare.csv cannot be read.
void reach_bare_bone(FatLayer& layer, const SkinRays& rays, const Anatomy& anatomy);

}  // namespace ecorche
