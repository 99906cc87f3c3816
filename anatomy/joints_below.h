// A joint and what hangs on it.
#pragma once

#include <vector>

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// #joints: 1 for `joint` and all that descend from it, 0 for others.
std::vector<char> joints_below(const Skeleton& skeleton, int joint);

}  // namespace ecorche::inline v1
