// Lays the sheets of the belly's wall, and those of the back, under one another.
//
// A big belly draws the strips of the external oblique apart, and between them its sheet lies lower
// than its strips do. Sections of the internal oblique and of transversus that would lie over the
// sheet that covers them there are moved inwards along the way to the nearest skin, evened along
// each strip. Behind the wall lies what is not drawn. On the back lie the rhomboids and the upper
// part of latissimus under the trapezius, whose lines are no farther out than theirs.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/queries/ray_caster.h"
#include "morph/dilation/bone_rays.h"

namespace ecorche::inline v1 {

enum class Wall { none, belly, back };

// Of a sheet: which wall it is of, and its place there, from the outermost, 1, on.
struct WallPlace {
  Wall wall = Wall::none;
  int depth = 0;

  bool operator==(const WallPlace&) const = default;
  bool is_under(const WallPlace& other) const {
    return wall != Wall::none && wall == other.wall && depth > other.depth;
  }
};

WallPlace place_in_wall(const Muscle& muscle);

// `slices`: the sections of all muscles in order. Those with a partner of which they are the mirror
// image stay: `partners` as in pack_muscles. `skin`: closed. `bones`: sections are not moved into
// them; may be null. Returns how far the section that went farthest has moved, m.
double lay_wall(const Anatomy& anatomy, std::span<Ellipse> slices, std::span<const int> partners,
                const SkinRays& skin, const BoneRays* bones = nullptr);

}  // namespace ecorche::inline v1
