// Joints of their own that go where the skeleton's joints leave the skin worst. Private to the
// room.
#pragma once

#include <span>
#include <vector>

#include "skinning/bake/bake_samples.h"

namespace ecorche {

// The skin about a helper: what it follows where nothing else is known.
struct HelperPatch {
  int center = 0;                                // vertex
  std::vector<std::pair<int, double>> vertices;  // and how much each counts
};

// The `count` vertices with the largest errors, no two of them closer than 0.1 m, and the skin
// within 0.06 m of each. `errors`: #V, m; those below `least` are left alone. V: rest, #V x 3.
std::vector<HelperPatch> choose_helpers(const Points& V, const Eigen::VectorXd& errors,
                                        double least, int count);

// The vertices that hang on each helper by enough to say where it is. `joints`: how many bones are
// no helpers.
std::vector<std::vector<int>> hung_on_helpers(Influences influences, std::size_t joints,
                                              std::size_t helpers);

// Where helpers are in a frame: the rigid map that brings its patch closest to the exact skin, and
// then in turn the one that brings the vertices that hang on it closest, the other bones held
// (after Le & Deng 2012, 10.1145/2366145.2366218). Sets the last patches.size() bones of `frame`.
// `hung`: as hung_on_helpers() has it. A function of the frame alone.
void pose_helpers(const Points& V, std::span<const HelperPatch> patches,
                  std::span<const std::vector<int>> hung, Influences influences, BakeFrame& frame);

}  // namespace ecorche
