// Layers of the chest in their order: what has come through a muscle that covers it is covered
// again.
//
// Rays go in from the layer of fat. Where one meets a rib, or a muscle that is not of the
// superficial layer, and within 8 mm below that a superficial one, this is raised there: the
// sections that the drawn triangle follows, in proportion to their inclination, and those next to
// them by a part of it, as far as the skin leaves room.
#pragma once

#include <span>

#include "anatomy/anatomy.h"
#include "anatomy/queries/ray_caster.h"
#include "morph/fat/fat_layer.h"

namespace ecorche::inline v1 {

// `slices`: the sections of all muscles in order, as the strips hold them; their outlines are
// changed, not the strips, those of mirror images (`partners` as for pack_muscles), and of muscles
// that are their own partners, excepted. `skin`: closed, with the layer `fat`. Returns the number
// of rays. Without ribs nothing is done. The same bytes at any number of threads.
long long restore_layers(const Anatomy& anatomy, std::span<Ellipse> slices,
                         std::span<const int> partners, const SkinRays& skin, const FatLayer& fat);

}  // namespace ecorche::inline v1
