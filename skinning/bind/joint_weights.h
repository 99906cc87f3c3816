// Joint weights of a skin by diffusion. Private to the room.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"
#include "skinning/bind/skin_depth.h"
#include "skinning/bind/skin_weights.h"

namespace ecorche::inline v1 {

// Diffuses the joints that `depth` has found over the skin: two screened Poisson solves
// (M / l^2 + L) w = M / l^2 p, whose length l grows with the local radius of the body and the depth
// of the bone. Two solves: the weights are smooth where one alone has a crease. Arms and legs are
// told from the trunk with a shorter length than the vertebrae from each other: a bend of the trunk
// is spread over the whole of it, but a raised arm must not take the flank along. Rows by rising
// joint, sum 1. Throws UnfitError when no vertex reaches a bone.
std::vector<WeightRow> diffuse_joint_weights(const Skeleton& skeleton, const TriMesh& skin,
                                             const SkinDepth& depth, double blend_width);

}  // namespace ecorche::inline v1
