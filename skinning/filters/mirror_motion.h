// A motion with left and right exchanged.
#pragma once

#include "skinning/filters/filtered_motion.h"

namespace ecorche::inline v1 {

// Mirrors the motion in the upright plane in which the figure faces in its first frame, so that it
// starts where it did. Twice is the motion itself. Joints are paired by their names' _l and _r.
void mirror_motion(const Skeleton& skeleton, FilteredMotion& filtered);

}  // namespace ecorche::inline v1
