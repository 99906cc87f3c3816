// Forces of fibres and tendons over the largest isometric force (Thelen 2003, 10.1115/1.1531112;
// Millard et al. 2013, 10.1115/1.4023390).
#pragma once

#include <cmath>

namespace ecorche::inline v1 {

inline constexpr double kMostTendonStrain = 0.049;  // under the largest isometric force
inline constexpr double kTendonToe = 0.609 * kMostTendonStrain;
inline constexpr double kTendonStiffness = 1.712 / kMostTendonStrain;  // beyond the toe
// Optimal fibre lengths a second
inline constexpr double kFastestFibre = 10;

// l: fibre length over the optimal one.
inline double active_force(double l) { return std::exp(-(l - 1) * (l - 1) / 0.45); }

inline double passive_force(double l) {
  return l <= 1 ? 0 : (std::exp(4 * (l - 1) / 0.6) - 1) / (std::exp(4.0) - 1);
}

// v: of lengthening over the fastest, -1 .. 1. Hill's hyperbola with a quarter of the force's
// curvature; lengthening fibres give up to 1.4 and set out with the same slope.
inline double velocity_force(double v) {
  if (v <= -1) return 0;
  return v <= 0 ? (1 + v) / (1 - 4 * v) : 1 + 0.4 * v / (v + 0.08);
}

inline double tendon_force(double strain) {
  if (strain <= 0) return 0;
  if (strain < kTendonToe)
    return 0.33 * (std::exp(3 * strain / kTendonToe) - 1) / (std::exp(3.0) - 1);
  return 0.33 + kTendonStiffness * (strain - kTendonToe);
}

// The inverse of tendon_force().
inline double tendon_strain(double force) {
  if (force <= 0) return 0;
  if (force < 0.33) return kTendonToe / 3 * std::log1p(force / 0.33 * (std::exp(3.0) - 1));
  return kTendonToe + (force - 0.33) / kTendonStiffness;
}

}  // namespace ecorche::inline v1
