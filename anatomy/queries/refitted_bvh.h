// A tree of boxes about the triangles of a surface that moves: the tree stays, its boxes are fitted
// anew to each pose. Eight boxes and eight triangles are looked at side by side (Wald, Benthin &
// Boulos 2008, 10.1109/RT.2008.4634620). Private to the room.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "anatomy/compute/simd.h"

namespace ecorche::inline v1 {

struct RefittedBvh {
  // >= 0: a node; otherwise a leaf of eight triangles, ~child the place of its first corner.
  std::vector<std::array<int, 8>>
      children;  // a node; parents before children. A node of fewer repeats its last one
  std::vector<int> corners;  // 24 a leaf: the first of each triangle, the second, the third
};

// `positions`: #V x 4; `triangles`: 3 indices each, four of them at least.
RefittedBvh make_refitted_bvh(std::span<const float> positions, std::span<const int> triangles);

inline constexpr std::size_t kTreeBox = 56;  // floats a node

// `boxes`: kTreeBox a node: low x of the eight children, low y, low z, high x, high y, high z; low
// and high corner of the whole. Allocates only when its size changes.
void fit_boxes(const RefittedBvh& tree, std::span<const float> positions,
               std::vector<float>& boxes);

// Distance to the first triangle between `near` and `far` along a direction of unit length if it is
// seen from behind; otherwise 0.
float back_seen(const RefittedBvh& tree, std::span<const float> boxes,
                std::span<const float> positions, Float4 from, Float4 direction, float near,
                float far);

// The same, but if it is seen from the front.
float front_seen(const RefittedBvh& tree, std::span<const float> boxes,
                 std::span<const float> positions, Float4 from, Float4 direction, float near,
                 float far);

inline constexpr float kHere = 2e-4f;  // m

// Distance to the first back up to `far`, whatever fronts lie before it; 0 without one. What is at
// the distance `own`, to kHere, is passed over.
float next_back(const RefittedBvh& tree, std::span<const float> boxes,
                std::span<const float> positions, Float4 from, Float4 direction, float own,
                float far);

}  // namespace ecorche::inline v1
