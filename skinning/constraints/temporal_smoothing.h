// How much of what frames around a frame ask for it gets, so that it begins before it is needed and
// fades out after.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace ecorche {

// Every value becomes the largest within `reach` frames of it (`larger(a, b)`: whether a is larger
// than b), then the mean under a cosine bell as wide: a value that stands alone is reached in its
// own frame and nowhere passed. Ends go on as they are. `reach` below 1: nothing changes.
template <typename Value, typename Larger>
void widened_bell(int reach, std::vector<Value>& values, Larger larger) {
  if (reach < 1) return;
  const int count = values.size();
  const auto at = [](auto& series, int f) -> auto& { return series[f]; };
  std::vector<Value> widened = values;
  for (int f = 0; f < count; ++f)
    for (int g = std::max(0, f - reach); g <= std::min(count - 1, f + reach); ++g)
      if (larger(at(values, g), at(widened, f))) at(widened, f) = at(values, g);
  for (int f = 0; f < count; ++f) {
    Value sum = 0 * at(widened, f);
    double weight = 0;
    for (int g = f - reach; g <= f + reach; ++g) {
      const double share = 1 + std::cos(std::numbers::pi * (g - f) / (reach + 1));
      sum += share * at(widened, std::clamp(g, 0, count - 1));
      weight += share;
    }
    at(values, f) = sum / weight;
  }
}

}  // namespace ecorche
