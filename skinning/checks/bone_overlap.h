// Bones within bones: the space that two bones both take, pair by pair.
#pragma once

#include <string>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

struct BonePair {
  std::string a, b;
  double volume = 0;  // m^3 that both take
};

struct BoneOverlap {
  double share = 0;             // of the bones' volume, what another bone takes too
  std::vector<BonePair> pairs;  // largest first
};

// `bones`: their meshes, closed and outward, in one frame. Lines every `spacing` metres (see
// overlap_volumes.h).
BoneOverlap measure_bone_overlap(const std::vector<Bone>& bones, double spacing);

}  // namespace ecorche::inline v1
