// From 0 to 1 without a corner.
#pragma once

#include <algorithm>

namespace ecorche::inline v1 {

inline double smooth_step(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}
inline double smooth_step(double x) { return smooth_step(0, 1, x); }

}  // namespace ecorche::inline v1
