// World frames of some joints alone, where the others do not matter.
#pragma once

#include <vector>

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// Joints and all above them, in the skeleton's order.
std::vector<int> joints_up_from(const Skeleton& skeleton, const std::vector<int>& joints);

// World frames X_WJ of `joints`, as forward_kinematics() gives them; of others `out` keeps what it
// has. `out` is resized once and then reused. Preconditions: `joints` as joints_up_from() gives
// them, pose.rotations has one entry a joint of the skeleton.
void chain_kinematics(const Skeleton& skeleton, const std::vector<int>& joints, const Pose& pose,
                      std::vector<Transform>& out);

}  // namespace ecorche::inline v1
