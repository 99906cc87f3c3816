#include "skinning/skin_frame.h"

namespace ecorche::inline v1 {

void to_points(const SkinFrame& frame, Points& out) {
  const Eigen::Index n = frame.positions.size() / 4;
  out.resize(n, 3);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < 3; ++k) out(i, k) = frame.positions[4 * i + k];
}

}  // namespace ecorche::inline v1
