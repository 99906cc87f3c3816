// Temporal smoothing of corrections: a maximum filter followed by a cosine kernel, so that a
// correction begins before the frame that needs it and fades out after it.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace ecorche::inline v1 {

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
    Value sum = 0 * at(largest, f);
    double weight = 0;
    for (int g = f - reach; g <= f + reach; ++g) {
      const double share = 1 + std::cos(std::numbers::pi * (g - f) / (reach + 1));
      sum += share * at(largest, std::clamp(g, 0, count - 1));
      weight += share;
    }
    at(values, f) = sum / weight;
  }
}

}  // namespace ecorche::inline v1
