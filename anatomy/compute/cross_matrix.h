// Cross products as matrices.
#pragma once

#include <Eigen/Core>

namespace ecorche::inline v1 {

// cross_matrix(v) w = v x w.
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d out;
  out << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return out;
}

}  // namespace ecorche::inline v1
