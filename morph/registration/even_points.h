// A scan as points that stand for even areas.
#pragma once

#include <cstddef>
#include <vector>

#include "morph/registration/point_tree.h"
#include "morph/registration/scan.h"

namespace ecorche::inline v1 {

struct EvenPoints {
  SurfacePoints surface;               // m, file's axes
  std::vector<float> area;             // m^2 that each stands for
  std::vector<char> border, covering;  // as of Scan; may be empty
  double spacing = 0;                  // m, between points of what was measured
};

// The scan's own points where there are many, else some 60,000 drawn over its triangles.
EvenPoints even_points(const Scan& scan);

// At most `count` of them, even by area, in an order of which every beginning is even.
EvenPoints spread_points(const EvenPoints& points, std::size_t count);

}  // namespace ecorche::inline v1
