// Which parts of a skin may meet in a pose, so that the others need not be looked at. Private to the room.
//
// The skin is cut into connected patches. Two of them may meet where they are within reach of each other, some of their normals are more
// than a right angle apart (what is met is met from its front), and they have come nearer than they are at rest: the far side of a finger
// is always near. A patch may meet itself where it has folded.
#pragma once

#include <span>
#include <vector>

#include "skinning/elastic_scratch.h"
#include "skinning/membrane.h"

namespace ecorche {

struct ContactPatches {
  std::vector<int> first, vertex;           // #patches + 1 into `vertex`: a patch's own
  std::vector<int> hull_first, hull;        // the same with the ring about them
  std::vector<float> reach;                 // a patch: m
  std::vector<float> rest_middle;           // #patches x 4
  std::vector<float> rest_spread;           // a patch: rad, largest angle of a normal with their mean
};

// `positions`, `normals`: #V x 4, rest; `give`: m, #V.
ContactPatches cut_patches(const Membrane& rings, std::span<const float> positions, std::span<const float> normals, std::span<const float> give);

// 1 for vertices that may be inside another patch, else 0; whether there is any. `give`: as above. Allocates only at first use.
bool find_meetings(const ContactPatches& patches, std::span<const float> give, std::span<const float> positions, std::span<const float> normals, PatchScratch& scratch,
                   std::vector<char>& wanted);

}  // namespace ecorche
