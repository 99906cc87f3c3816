// Where in space something is or has changed: cells of a grid.
#pragma once

#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

class TouchedCells {
 public:
  // Of `space`, in cells of `size`, m. What is marked beyond it is forgotten.
  TouchedCells(const Eigen::AlignedBox3d& space, double size);

  void clear();
  void mark(const Eigen::AlignedBox3d& box);
  // Whether a line comes through what was marked. Never misses what lies in `space`; may say so of
  // what it only passes by, by a cell. Precondition: direction of length one.
  bool touches(const Vec3& from, const Vec3& direction, double length) const;
  // Whether a box does: as above, without the neighbours.
  bool touches(const Eigen::AlignedBox3d& box) const;

 private:
  Eigen::Array3i cell(const Vec3& point) const {
    return ((point - corner_).array() / size_).floor().cast<int>();
  }

  Vec3 corner_;
  double size_;
  Eigen::Array3i count_;
  std::vector<char> marked_;
};

}  // namespace ecorche::inline v1
