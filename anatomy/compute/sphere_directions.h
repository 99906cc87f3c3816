// Unit vectors spread evenly over the sphere.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <vector>

namespace ecorche::inline v1 {

// Along a Fibonacci spiral.
inline std::vector<Eigen::Vector3d> sphere_directions(int count) {
  std::vector<Eigen::Vector3d> out(count);
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int k = 0; k < count; ++k) {
    const double z = 1 - (2 * k + 1.0) / count, r = std::sqrt(1 - z * z);
    out[k] = {r * std::cos(golden * k), r * std::sin(golden * k), z};
  }
  return out;
}

}  // namespace ecorche::inline v1
