// Writes Biovision hierarchy (.bvh) motions.
#pragma once

#include <string>

#include "anatomy/skeleton.h"
#include "skinning/motion_files/bvh_motion.h"

namespace ecorche::inline v1 {

// Text with '\n' line ends and as many digits as a double needs to come back to 1e-9.
// Precondition (std::invalid_argument): samples has frames x channels finite entries.
std::string format_bvh(const BvhMotion& motion);

// Our own skeleton and a motion of it as a BVH in metres, joint names ours, every joint's rotation
// in Z-X-Y order.
BvhMotion to_bvh(const Skeleton& skeleton, const Motion& motion);

}  // namespace ecorche::inline v1
