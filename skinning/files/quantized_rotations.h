// Quantised rotations of engine files: the components of a unit quaternion as 16-bit integers,
// 32767 for 1. Half the bytes of floats, error below 0.004 degrees.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// x, y, z, w. Precondition: |q| = 1
inline std::array<std::int16_t, 4> quantize(const Quat& q) {
  std::array<std::int16_t, 4> out;
  for (std::size_t k = 0; k < 4; ++k) out[k] = std::int16_t(std::lround(32767 * q.coeffs()[k]));
  return out;
}

// A joint's rotations with consecutive quaternions on one hemisphere, so that linear interpolation
// takes the short way.
inline std::vector<Quat> continuous_rotations(const Motion& motion, std::size_t joint) {
  std::vector<Quat> out;
  Quat last = Quat::Identity();
  for (const Pose& pose : motion.frames) {
    Quat q = pose.rotations[joint].normalized();
    if (q.dot(last) < 0) q.coeffs() = -q.coeffs();
    out.push_back(last = q);
  }
  return out;
}

// The rotation that is read back from a file.
inline Quat quantized(const Quat& q) {
  const std::array<std::int16_t, 4> kept = quantize(q.normalized());
  return Quat(kept[3], kept[0], kept[1], kept[2]).normalized();
}

inline Pose quantized(Pose pose) {
  for (Quat& turn : pose.rotations) turn = quantized(turn);
  return pose;
}

}  // namespace ecorche::inline v1
