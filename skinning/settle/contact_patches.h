// Broad phase of self-contact: vertices of a skin that may be inside another part of it in a pose.
// Private to the room.
//
// The skin is cut into connected patches. Two patches may meet where they are within reach of each
// other, some of their normals are more than a right angle apart (parts meet front to front), and
// they are nearer than at rest: the far side of a finger is always near. A patch may meet itself
// where it has folded. A vertex of a patch is a candidate if its way inwards leads through a small
// part of the other patch.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "skinning/settle/membrane.h"
#include "skinning/settle/settle_workspace.h"

namespace ecorche::inline v1 {

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
  std::vector<float> fold;          // a patch: cosine of its spread below which it has folded
  std::vector<int> part_first;      // #patches + 1 into `parts`: small pieces of it
  std::vector<int> eight_first{0};  // #patches + 1: the same in eights of parts
  VertexGroups parts;
};

// `positions`, `normals`: #V x 4, rest; `max_push`: m, #V.
ContactPatches cut_patches(const Membrane& rings, std::span<const float> positions,
                           std::span<const float> normals, std::span<const float> max_push);

// The ray of every vertex: from `before` in front of it to `max_push` behind it, along its normal.
struct ContactRays {
  std::span<const float> max_push;            // #V m; 0 for those that are left alone
  float before = 0;                           // m
  std::span<const float> positions, normals;  // #V x 4
};

// Fills `wanted`: 1 for vertices that may be inside another patch, else 0. Whether there is any.
// Allocates only at first use.
bool find_contact_vertices(const ContactPatches& patches, const ContactRays& skin,
                           PatchWorkspace& workspace, std::vector<char>& wanted);

}  // namespace ecorche::inline v1
