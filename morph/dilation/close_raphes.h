// Muscles that meet their own mirror image in a raphe reach it: the linea alba between the recti.
//
// Bodies widen as they are fitted, and what was side by side parts. The edges next to the mid-plane
// go to the middle between them, the other edges stay, so that sections turn and widen.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// `slices`: the sections of all muscles in order, whose centres, axes and radii are changed.
void close_raphes(std::span<const Muscle> muscles, std::span<Ellipse> slices);

}  // namespace ecorche::inline v1
