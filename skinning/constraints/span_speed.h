// Speeds over one span of time, so that they hardly depend on the rate of the frames.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Mean speed, m/s, of a point over the last 1/120 s before a frame, or over the frame before where
// frames are farther apart. `path`: places of points, m, by frame. Precondition: frame > 0.
template <std::size_t Points>
double span_speed(const std::vector<std::array<Vec3, Points>>& path, std::size_t frame,
                  std::size_t point, double fps) {
  constexpr double kSpan = 1.0 / 120;  // s
  const std::size_t span = std::max<std::size_t>(1, std::size_t(std::lround(kSpan * fps)));
  const std::size_t from = frame > span ? frame - span : 0;
  return fps * (path[frame][point] - path[from][point]).norm() / double(frame - from);
}

}  // namespace ecorche::inline v1
