// Helper joints where the skeleton's joints leave the largest errors. Private to the room.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "skinning/bake/bake_samples.h"

namespace ecorche::inline v1 {

// The skin around a helper, which places it before any vertex has a weight for it.
struct HelperPatch {
  int center = 0;                                // vertex
  std::vector<std::pair<int, double>> vertices;  // and weights
};

// The `count` vertices with the largest errors, no two of them closer than 0.1 m, and the skin
// within 0.06 m of each. `errors`: #V, m; those below `least` are left alone. V: rest, #V x 3.
std::vector<HelperPatch> choose_helpers(const Points& V, const Eigen::VectorXd& errors,
                                        double least, int count);

// Vertices with a significant weight for each helper. `joints`: number of bones that are no
// helpers.
std::vector<std::vector<int>> vertices_of_helpers(Influences influences, std::size_t joints,
                                                  std::size_t helpers);

// Poses the helpers of a frame: each by the rigid map that brings its patch closest to the exact
// skin, and then, one after the other, by the one that brings its own vertices closest, with the
// other bones fixed (after Le & Deng 2012, 10.1145/2366145.2366218). Sets the last patches.size()
// bones of `frame`. `skinned`: of vertices_of_helpers(). Depends on the one frame alone.
void pose_helpers(const Points& V, std::span<const HelperPatch> patches,
                  std::span<const std::vector<int>> skinned, Influences influences,
                  BakeFrame& frame);

}  // namespace ecorche::inline v1
