// Rows of skin weights while a skin is bound. Private to the room.
#pragma once

#include <vector>

#include "anatomy/geometry/subdivide.h"
#include "skinning/bind/blend_tables.h"
#include "skinning/binding.h"

namespace ecorche::inline v1 {

// Of one vertex: joints, blend frames or muscle handles by index; positive weights.
using WeightRow = std::vector<Influence>;

struct SkinWeights {
  std::vector<WeightRow> frames;   // #V, of blend frames; joints, twist and slide frames sum to 1
  std::vector<WeightRow> handles;  // #V, of muscle handles; empty: there are none
};

// Largest number of weights a vertex has, and the weight below which one is dropped. More weights
// or a smaller bound cost time in every frame and change the skin by less than the eye sees.
inline constexpr double kLeastWeight = 0.015;
inline constexpr int kMostJoints = 6, kMostPairs = 4, kMostHandles = 3;

// Drops weights below `least`, smoothly (each loses `least` before the row's own sum is restored),
// and keeps at most `most` a row.
void thin_weights(std::vector<WeightRow>& rows, double least, int most);

// The four largest joint weights of each row. Twist frames and slides count for
// FrameTables::joint_of(), frame pairs for nothing.
std::vector<JointWeights> four_joint_weights(const std::vector<WeightRow>& frames,
                                             const FrameTables& tables);

// Weights of the vertices of a refined mesh: the same blend of the base vertices' weights as of
// their positions.
SkinWeights refine_weights(const Refinement& refinement, const SkinWeights& base,
                           const FrameTables& frames, int handle_count);

}  // namespace ecorche::inline v1
