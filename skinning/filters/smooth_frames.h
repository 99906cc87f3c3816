// Smoothing of a motion over time.
#pragma once

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// Every frame becomes the mean of those within half of `width` (s), under a raised cosine. Beyond
// its ends the motion goes on point-symmetrically, so that its first and last frame stay. A width
// below two frames changes nothing.
void smooth_frames(double width, Motion& motion);

}  // namespace ecorche::inline v1
