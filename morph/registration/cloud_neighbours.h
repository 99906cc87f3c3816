// The nearest points of each point of a cloud.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct CloudNeighbours {
  int count = 0;                // of each point; fewer points than that: all others, then itself
  std::vector<int> index;       // #N x count, nearest first, without the point itself
  std::vector<float> distance;  // #N x count, m

  std::span<const int> of(int i) const {
    return std::span(index).subspan(std::size_t(i) * count, count);
  }
  std::span<const float> distances(int i) const {
    return std::span(distance).subspan(std::size_t(i) * count, count);
  }
};

// A kd-tree, on all threads. Precondition: finite coordinates.
CloudNeighbours nearest_neighbours(const Points& points, int count);

}  // namespace ecorche::inline v1
