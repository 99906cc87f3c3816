// A smooth curve near wanted values and nowhere below others, for corrections that are to be as
// small as they can be without being sudden.
#pragma once

#include <vector>

namespace ecorche::inline v1 {

// What a curve is to be at a sample.
struct WantedValue {
  double value = 0;
  double weight = 0;      // of its square distance from `value`; above 0
  double least = -1e300;  // it is not below
};

// The curve s with the least of
//   integral of weight (s - value)^2 + ease^4 integral of s''^2,
// nowhere below `least`. ease, s: how long it takes to follow, to either side of a sudden change.
// A quadratic programme; its active set is found by adding the worst sample of every span that is
// below, and dropping samples that hold the curve down.
std::vector<double> smooth_above(const std::vector<WantedValue>& wanted, double fps, double ease);

}  // namespace ecorche::inline v1
