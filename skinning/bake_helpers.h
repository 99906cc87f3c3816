// Joints of their own that go where the skeleton's joints leave the skin worst. Private to the room.
#pragma once

#include <span>
#include <vector>

#include "skinning/bake_samples.h"

namespace ecorche {

// The skin about a helper: what it follows where nothing else is known.
struct HelperPatch {
  int center = 0;  // vertex
  std::vector<std::pair<int, double>> vertices;  // and how much each counts
};

// The `count` vertices with the largest errors, no two of them closer than 0.1 m, and the skin within 0.06 m of each. `errors`: #V, m;
// those below `least` are left alone. V: rest, #V x 3.
std::vector<HelperPatch> choose_helpers(const Points& V, const Eigen::VectorXd& errors, double least, int count);

// Where helpers are in a frame: the rigid map that brings its patch closest to the exact skin, refined in `rounds` rounds. Sets the last
// patches.size() bones of `frame`. A function of the frame alone.
void pose_helpers(const Points& V, std::span<const HelperPatch> patches, std::span<const std::array<Influence, 4>> influences, int rounds, BakeFrame& frame);

// Moves each helper in turn so that the vertices that hang on it come closest to the exact skin, the other bones held (after Le & Deng 2012,
// 10.1145/2366145.2366218). `places`: of the vertices in the rest pose, with their shapes; `weights`: how much each counts, #V.
void refine_helpers(const Points& places, std::span<const HelperPatch> patches, std::span<const std::array<Influence, 4>> influences,
                    const Eigen::VectorXd& weights, BakeFrame& frame);

}  // namespace ecorche
