// Vertices that stand for the skin about them.
#pragma once

#include <vector>

#include "skinning/interior/harmonic_weights.h"

namespace ecorche::inline v1 {

struct SkinControls {
  std::vector<int> vertices;           // no two closer than `spacing` along the skin's edges
  std::vector<SourceWeights> weights;  // #V, of the controls within twice as far
};

SkinControls choose_skin_controls(const TriMesh& skin, double spacing);

}  // namespace ecorche::inline v1
