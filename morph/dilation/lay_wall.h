// Lays the sheets of the belly's wall under one another.
//
// A big belly draws the strips of the external oblique apart, and between them its sheet lies lower
// than its strips do. Sections of the internal oblique and of transversus that would lie over the
// sheet that covers them there are moved inwards along the way to the nearest skin, evened along
// each strip. Behind the wall lies what is not drawn.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/queries/ray_caster.h"

namespace ecorche::inline v1 {

// Of a sheet of the belly's wall its place, from the outermost, 1, to 3; 0: none of them.
int depth_in_wall(const Muscle& muscle);

// `slices`: the sections of all muscles in order. Those with a partner of which they are the mirror
// image stay: `partners` as in pack_muscles. `skin`: closed. Returns how far the section that went
// farthest has moved, m.
double lay_wall(const Anatomy& anatomy, std::span<Ellipse> slices, std::span<const int> partners,
                const SkinRays& skin);

}  // namespace ecorche::inline v1
