// How errors count where the largest matter most: sum of e^2 / 2 + s^2 / p (e / s)^p. Private to
// the room.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "anatomy/types.h"

namespace ecorche {

inline constexpr double kCostPower = 12;  // p
// s, m: larger errors count by their power, smaller by their square
inline constexpr double kCostScale = 3e-3;

// (e / s)^(p - 2): the power's share in how much an error counts beside the square's 1.
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

// Newton's second derivative of a vertex' cost by its place is root' root, its first root' rest.
struct CostRoot {
  Mat3 root;
  Vec3 rest;
};

// `off`: from where the vertex should be to where it is, m. `even`: by the squares alone.
inline CostRoot cost_root(const Vec3& off, bool even) {
  const double e = std::max(off.norm(), 1e-12), steep = even ? 0 : steepness(e);
  const Vec3 u = off / e;
  const double across = std::sqrt(1 + steep), along = std::sqrt(1 + (kCostPower - 1) * steep);
  return {across * Mat3::Identity() + (along - across) * u * u.transpose(),
          (1 + steep) / along * off};
}

}  // namespace ecorche
