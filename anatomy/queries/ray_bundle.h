// Short rays that begin close together: the leaves of a tree that any of them may cross are found
// once for all, and their triangles laid out. Private to the room.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "anatomy/compute/simd_lanes.h"
#include "anatomy/queries/refitted_bvh.h"

namespace ecorche::inline v1 {

struct RayBundle {
  static constexpr std::size_t kMost = 128;  // leaves
  struct Leaf {
    Wide3 corner, first, second,
        normal;  // of eight triangles: a corner, the edges from it, their product
  };
  std::size_t count = 0;
  alignas(32) std::array<float, 6 * kMost> boxes;  // 48 for each eight leaves, as a tree's
  std::array<Leaf, kMost> leaves;
};

// The leaves that reach into a box. False where they are too many: the bundle is of no use then.
bool gather_leaves(const RefittedBvh& tree, std::span<const float> boxes,
                   std::span<const float> positions, Float4 low, Float4 high, RayBundle& out);

// next_back() of the tree, for a ray within that box.
float next_back(const RayBundle& bundle, Float4 from, Float4 direction, float own, float far);

}  // namespace ecorche::inline v1
