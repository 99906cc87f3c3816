// Parts of a skin that meet are pressed flat against each other instead of passing through. Private
// to the room.
//
// A vertex is too near when a point a little before it is inside another part: the first thing that
// is seen from there along its normal is the back of a triangle. It then goes half of the way to
// where that point is free; the other part's vertices go the other half. What is left between parts
// keeps their edges out of each other, not only their vertices. The ring about them follows a
// little, so that the dent has no edge. Vertices that lie inside something at rest (lips, eyelids,
// the mouth) are left alone.
#pragma once

#include <span>
#include <vector>

#include "anatomy/queries/refitted_bvh.h"
#include "anatomy/types.h"
#include "skinning/settle/contact_patches.h"
#include "skinning/settle/membrane.h"

namespace ecorche {

struct SkinContact {
  std::vector<float>
      give;  // #V m, how far each vertex may be pushed; 0 for those that are left alone
  std::vector<float> gap;  // #V m, that is left before each; less than what is before it at rest
  std::vector<int> about_first, about;  // #V + 1 into the triangles about each vertex, by 3 corners
  ContactPatches patches;
  FittedTree tree;
};

// `positions`: #V x 4, rest; `triangles`: 3 indices each; `tissue`: what lies between skin and
// bone, m, #V.
SkinContact make_skin_contact(const Membrane& rings, std::span<const float> positions,
                              std::span<const int> triangles, std::span<const double> tissue);

// Parts `positions` (#V x 4) by rounds, adding to them; whether any has moved: scratch.before then
// has all as they were. `normals` become those of the parted skin. Allocates only at first use;
// same input, same bytes at any number of threads.
bool part_skin(const Membrane& rings, const SkinContact& contact, std::span<const int> triangles,
               int rounds, std::span<float> positions, std::vector<float>& normals,
               ContactScratch& scratch);

}  // namespace ecorche
