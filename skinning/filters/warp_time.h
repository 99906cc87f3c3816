// A motion played faster or slower, in another length or at another rate of frames.
#pragma once

#include "skinning/filters/filtered_motion.h"

namespace ecorche::inline v1 {

// `speed` times as fast, as near to it as whole frames allow, from the first to the last frame as
// before. Feet stand in the same parts of the motion, treadmills go faster, and flights fall by
// gravity times the square.
void warp_time(double speed, FilteredMotion& filtered);

// As warp_time, so that the last frame, or a loop's return, is `length` (s) after the first one.
void fit_length(double length, FilteredMotion& filtered);

// The same motion in other frames. Throws LimitError for more frames than a motion may have, as
// the others.
void change_rate(double fps, FilteredMotion& filtered);

}  // namespace ecorche::inline v1
