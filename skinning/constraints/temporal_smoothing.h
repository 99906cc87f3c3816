// Temporal smoothing of corrections: a maximum filter followed by a cosine kernel, so that a
// correction begins before the frame that needs it and fades out after it.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace ecorche::inline v1 {

// Mean of at(k), k whole and no farther from 0 than `width`, under a raised cosine. `zero`: of the
// values' kind and size.
template <typename Value, typename At>
Value raised_cosine_mean(double width, Value zero, const At& at) {
  const int reach = int(width);
  double weight = 0;
  for (int k = -reach; k <= reach; ++k) {
    const double share = 1 + std::cos(std::numbers::pi * k / (width + 1));
    zero += share * at(k);
    weight += share;
  }
  return zero / weight;
}

// Every value becomes the largest within `reach` frames of it (`larger(a, b)`: whether a is larger
// than b), then the mean under a raised cosine of the same width. An isolated value is reached in
// its own frame and exceeded nowhere. The first and last values extend beyond the ends. `reach`
// below 1: nothing changes.
template <typename Value, typename Larger>
void smooth_maximum(int reach, std::vector<Value>& values, Larger larger) {
  if (reach < 1) return;
  const int count = values.size();
  const auto at = [](auto& series, int f) -> auto& { return series[f]; };
  std::vector<Value> largest = values;
  for (int f = 0; f < count; ++f)
    for (int g = std::max(0, f - reach); g <= std::min(count - 1, f + reach); ++g)
      if (larger(at(values, g), at(largest, f))) at(largest, f) = at(values, g);
  for (int f = 0; f < count; ++f) {
    at(values, f) = raised_cosine_mean(
        reach, Value(0 * at(largest, f)),
        [&](int k) -> const Value& { return at(largest, std::clamp(f + k, 0, count - 1)); });
  }
}

}  // namespace ecorche::inline v1
