// Values along a strip, smoothed. Private to the room.
#pragma once

#include <cstddef>
#include <vector>

namespace ecorche::inline v1 {

// A running mean of three, some times over; the ends stay.
template <class Value>
void smooth_along(std::vector<Value>& values, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    Value before = values.front();
    for (std::size_t k = 1; k + 1 < values.size(); ++k) {
      const Value here = values[k];
      values[k] = (before + 2 * here + values[k + 1]) / 4;
      before = here;
    }
  }
}

}  // namespace ecorche::inline v1
