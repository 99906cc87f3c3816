#include "anatomy/queries/occupancy_grid.h"

#include <algorithm>
#include <cmath>

namespace ecorche::inline v1 {

TouchedCells::TouchedCells(const Eigen::AlignedBox3d& space, double size)
    : corner_(space.min() - Vec3::Constant(size)),
      size_(size),
      count_((space.sizes().array() / size).floor().cast<int>() + 3),
      marked_(std::size_t(count_.prod()), 0) {}

void TouchedCells::clear() { std::fill(marked_.begin(), marked_.end(), 0); }

// A line is looked at in steps of a cell, so that nothing of it is farther than half a cell from a
// place that was looked at.
void TouchedCells::mark(const Eigen::AlignedBox3d& box) {
  const Vec3 around = Vec3::Constant(0.5 * size_);
  const Eigen::Array3i low = cell(box.min() - around).max(0),
                       high = cell(box.max() + around).min(count_ - 1);
  for (int x = low.x(); x <= high.x(); ++x)
    for (int y = low.y(); y <= high.y(); ++y)
      for (int z = low.z(); z <= high.z(); ++z) marked_[(x * count_.y() + y) * count_.z() + z] = 1;
}

bool TouchedCells::touches(const Eigen::AlignedBox3d& box) const {
  const Eigen::Array3i low = cell(box.min()).max(0), high = cell(box.max()).min(count_ - 1);
  for (int x = low.x(); x <= high.x(); ++x)
    for (int y = low.y(); y <= high.y(); ++y)
      for (int z = low.z(); z <= high.z(); ++z)
        if (marked_[(x * count_.y() + y) * count_.z() + z]) return true;
  return false;
}

bool TouchedCells::touches(const Vec3& from, const Vec3& direction, double length) const {
  const int steps = std::ceil(length / size_);
  for (int step = 0; step <= steps; ++step) {
    const Eigen::Array3i at = cell(from + std::min(step * size_, length) * direction);
    if ((at < 0).any() || (at >= count_).any()) continue;
    if (marked_[(at.x() * count_.y() + at.y()) * count_.z() + at.z()]) return true;
  }
  return false;
}

}  // namespace ecorche::inline v1
