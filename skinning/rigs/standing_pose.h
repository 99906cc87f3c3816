// The pose of a skeleton in which a skin stands, from the skin at rest.
#pragma once

#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/binding.h"

namespace ecorche::inline v1 {

// Rotation of each joint: the rigid motion that carries the vertices with its weights from `rest`
// to `standing` best (Kabsch); joints that few vertices tell of keep their parent's. The root is
// placed so that the skin's middle, by its weights, is where it stands. Precondition: as many rows
// and weights as vertices.
Pose standing_pose(const Skeleton& skeleton, const Points& rest, const Points& standing,
                   const std::vector<JointWeights>& weights);

}  // namespace ecorche::inline v1
