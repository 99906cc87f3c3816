// Angles between vectors.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>

namespace ecorche::inline v1 {

// 0 .. pi, rad; exact for small angles, too. Vectors of any length.
inline double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace ecorche::inline v1
