// Joint influences: four of joints, and of helper joints where those leave the largest errors.
// Private to the room.
#pragma once

#include <array>
#include <vector>

#include "skinning/bake/bake_helpers.h"
#include "skinning/bake/bake_samples.h"

namespace ecorche::inline v1 {

struct BakeRig {
  std::vector<std::array<Influence, 4>> influences;  // #V; joints, and then helpers, by index
  std::vector<BakeHelper> helpers;
  std::vector<HelperPatch> patches;  // of the helpers
};

// Solves for influences and helpers on `samples`, whose bones get the helpers.
BakeRig solve_rig(const BakeScene& scene, std::vector<BakeFrame>& samples);

}  // namespace ecorche::inline v1
