// A motion's pose at any time.
#pragma once

#include <span>

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// Interpolates by a smooth curve through the frames (Catmull & Rom 1974,
// 10.1016/B978-0-12-079050-0.50020-5; rotations as normalised sums of quaternions), so that
// accelerations of soft tissue and films at another rate have no kinks at the frames. Constant
// before the first and after the last frame. `time`: s from the first frame. `out` is resized once.
// Precondition: the motion has frames.
void pose_at(const Motion& motion, double time, Pose& out);

// The same at a frame, from 0, or between two; whole ones are the motion's own to the bit.
void pose_at_frame(const Motion& motion, double frame, Pose& out);

// The same of a point's path, a place a frame. Precondition: the path has frames.
Vec3 place_at_frame(std::span<const Vec3> path, double frame);

}  // namespace ecorche::inline v1
