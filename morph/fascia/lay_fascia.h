// Sheets of fascia on a body's muscles and bones.
//
// A smooth patch through a plan's control points is drawn as a grid; each of its points is looked
// down on from the skin, along the patch's normal, and lies where muscle or bone is met first. The
// edge stays there; between, the sheet is a taut membrane that may stand off what is below it and
// may not sink in: heights h along the normals that minimise the sum of squared distances of points
// from the mean of their neighbours, floor <= h <= ceiling (an obstacle problem, by projected
// successive over-relaxation; Cryer 1971, 10.1137/0309028). So it bridges furrows between muscles.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/authoring/fascia_table.h"
#include "anatomy/muscles/transform_muscles.h"
#include "anatomy/queries/ray_caster.h"

namespace ecorche::inline v1 {

// Control points where the bones that carry them go.
std::vector<FasciaPlan> carry_fascia(const std::vector<FasciaPlan>& plans, const CarryMap& map);

// `anatomy`: at rest, with muscles as they are drawn. `skin`: rays of its skin, closed. Plans that
// name a bone which the anatomy lacks are left out. The same bytes at any number of threads.
std::vector<FasciaSheet> lay_fascia(std::span<const FasciaPlan> plans, const Anatomy& anatomy,
                                    const SkinRays& skin);

}  // namespace ecorche::inline v1
