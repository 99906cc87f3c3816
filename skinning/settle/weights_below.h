// How much of each vertex goes with a joint and what hangs on it. Private to the room.
#pragma once

#include <span>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/binding.h"

namespace ecorche::inline v1 {

// Sums of the joint weights of `joint` and its descendants, #V.
std::vector<double> weights_below(const Skeleton& skeleton, int joint,
                                  std::span<const JointWeights> joint_weights);

}  // namespace ecorche::inline v1
