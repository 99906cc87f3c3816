#include "skinning/skin_frame.h"

#include <cstddef>

namespace ecorche::inline v1 {

void to_frame(const Points& positions, const Points& normals, SkinFrame& out) {
  out.positions.resize(4 * std::size_t(positions.rows()));
  out.normals.resize(out.positions.size());
  for (Eigen::Index v = 0; v < positions.rows(); ++v)
    for (int axis = 0; axis < 4; ++axis) {
      const std::size_t at = std::size_t(4 * v + axis);
      out.positions[at] = axis < 3 ? float(positions(v, axis)) : 1;
      out.normals[at] = axis < 3 ? float(normals(v, axis)) : 0;
    }
}

void to_points(const SkinFrame& frame, Points& out) {
  const Eigen::Index n = frame.positions.size() / 4;
  out.resize(n, 3);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < 3; ++k) out(i, k) = frame.positions[4 * i + k];
}

}  // namespace ecorche::inline v1
