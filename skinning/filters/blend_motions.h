// Two motions of one body made one.
#pragma once

#include <string>

#include "skinning/filters/filtered_motion.h"

namespace ecorche::inline v1 {

// Where the second motion begins in the first one, and how long one goes over into the other.
struct Transition {
  double at = 0, over = 0.3;  // s
};

// Up to `at` the first motion, from at + over the second one from where it then is, which begins at
// `at`; it is turned and shifted on the ground so that it goes on where the first one is in the
// middle of the transition. Feet that stand in either stand; in the middle half of the transition
// they are free. Throws UnfitError where one of the motions ends before the transition does.
// `name`: of the first one's file.
void go_over_to(const std::string& name, FilteredMotion second, const Transition& transition,
                FilteredMotion& filtered);

// All of both at once, `share` of the second one: its time is stretched over the first one's, its
// first frame comes to where the first one's is. 0: the first motion, 1: the second one.
void mix_with(FilteredMotion second, double share, FilteredMotion& filtered);

}  // namespace ecorche::inline v1
