// A motion's pose at any time.
#pragma once

#include "anatomy/skeleton.h"

namespace ecorche {

// On a smooth curve through the frames (Catmull & Rom 1974, 10.1016/B978-0-12-079050-0.50020-5;
// turns as normalised sums of quaternions), so that what is read off it, accelerations of loose
// flesh or a film at another rate, has no kinks at the frames. Before the first and after the last
// frame it stays. `time`: s from the first frame. `out` is resized once. Precondition: the motion
// has frames.
void pose_at(const Motion& motion, double time, Pose& out);

}  // namespace ecorche
