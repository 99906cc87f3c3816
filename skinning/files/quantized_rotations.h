// Turns as engine files keep them: the four parts of a unit quaternion as 16-bit integers, 32767
// for 1; half the bytes of floats, off by less than 0.004 degrees.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "anatomy/skeleton.h"

namespace ecorche {

// x, y, z, w. Precondition: |q| = 1
inline std::array<std::int16_t, 4> to_shorts(const Quat& q) {
  std::array<std::int16_t, 4> out;
  for (std::size_t k = 0; k < 4; ++k) out[k] = std::int16_t(std::lround(32767 * q.coeffs()[k]));
  return out;
}

// A joint's turns, on one hemisphere from key to key, so that linear players do not turn the long
// way round.
inline std::vector<Quat> steady_turns(const Motion& motion, std::size_t joint) {
  std::vector<Quat> out;
  Quat last = Quat::Identity();
  for (const Pose& pose : motion.frames) {
    Quat q = pose.rotations[joint].normalized();
    if (q.dot(last) < 0) q.coeffs() = -q.coeffs();
    out.push_back(last = q);
  }
  return out;
}

// As it comes back from a file.
inline Quat kept_in_shorts(const Quat& q) {
  const std::array<std::int16_t, 4> kept = to_shorts(q.normalized());
  return Quat(kept[3], kept[0], kept[1], kept[2]).normalized();
}

inline Pose kept_in_shorts(Pose pose) {
  for (Quat& turn : pose.rotations) turn = kept_in_shorts(turn);
  return pose;
}

}  // namespace ecorche
