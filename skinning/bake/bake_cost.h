// Cost of errors that penalises the largest: sum of e^2 / 2 + s^2 / p (e / s)^p. Private to the
// room.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

inline constexpr double kCostPower = 12;  // p
// s, m: larger errors are dominated by the power term, smaller by the square
inline constexpr double kCostScale = 3e-3;

// (e / s)^(p - 2): ratio of the gradients of the power term and the square.
inline double steepness(double error) {
  const double x = error * error / (kCostScale * kCostScale), x2 = x * x;
  return x2 * x2 * x;
}

inline double cost_of(double error) {
  return error * error * (0.5 + steepness(error) / kCostPower);
}

inline double cost_of(const Eigen::VectorXd& errors) {
  double sum = 0;
  for (const double e : errors) sum += cost_of(e);
  return sum;
}

// Derivatives of a vertex's cost by its position: the second is root' root, the first root' rest.
struct CostRoot {
  Mat3 root;
  Vec3 rest;
};

// `off`: error of the vertex, m. `least_squares`: the square term alone.
inline CostRoot cost_root(const Vec3& off, bool least_squares) {
  const double e = std::max(off.norm(), 1e-12), steep = least_squares ? 0 : steepness(e);
  const Vec3 u = off / e;
  const double across = std::sqrt(1 + steep), along = std::sqrt(1 + (kCostPower - 1) * steep);
  return {across * Mat3::Identity() + (along - across) * u * u.transpose(),
          (1 + steep) / along * off};
}

}  // namespace ecorche::inline v1
