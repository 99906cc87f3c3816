// Which parts of a skin may meet in a pose, so that the others need not be looked at. Private to
// the room.
//
// The skin is cut into connected patches. Two of them may meet where they are within reach of each
// other, some of their normals are more than a right angle apart (what is met is met from its
// front), and they have come nearer than they are at rest: the far side of a finger is always near.
// A patch may meet itself where it has folded. A vertex is then looked at if its way in leads
// through a small part of the other patch.
#pragma once

#include <span>
#include <vector>

#include "skinning/settle/membrane.h"
#include "skinning/settle/settle_workspace.h"

namespace ecorche {

// Connected vertices.
struct VertexGroups {
  std::vector<int> first{0}, vertex;     // #groups + 1 into `vertex`
  std::vector<int> hull_first{0}, hull;  // the same with the ring about them
};

std::span<const int> own_of(const VertexGroups& groups, std::size_t group);

struct ContactPatches {
  VertexGroups groups;
  std::vector<float> reach;         // a patch: m
  std::vector<float> rest_middle;   // #patches x 4
  std::vector<float> fold;          // a patch: the cosine of its spread is less where it has folded
  std::vector<int> part_first;      // #patches + 1 into `parts`: small pieces of it
  std::vector<int> eight_first{0};  // #patches + 1: the same in eights of parts
  VertexGroups parts;
};

// `positions`, `normals`: #V x 4, rest; `give`: m, #V.
ContactPatches cut_patches(const Membrane& rings, std::span<const float> positions,
                           std::span<const float> normals, std::span<const float> give);

// What is looked at of every vertex: from `before` in front of it to `give` behind it, along its
// normal.
struct SkinReach {
  std::span<const float> give;                // #V m; 0 for those that are left alone
  float before = 0;                           // m
  std::span<const float> positions, normals;  // #V x 4
};

// 1 for vertices that may be inside another patch, else 0; whether there is any. Allocates only at
// first use.
bool find_meetings(const ContactPatches& patches, const SkinReach& skin, PatchScratch& scratch,
                   std::vector<char>& wanted);

}  // namespace ecorche
