// Arithmetic on eight directions of an outline at once, and the level (normalised radius) of points
// in a section. Private to contact.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "anatomy/compute/simd.h"
#include "anatomy/contact/contact_table.h"

namespace ecorche::inline v1 {

// Masks of comparisons, read by 64 bits.
typedef std::int64_t FourMasks __attribute__((vector_size(32)));
typedef std::int64_t TwoMasks __attribute__((vector_size(16)));
static_assert(sizeof(Float8) == sizeof(RadialSamples));

template <class V>
inline void store(V v, float* p) {
  std::memcpy(p, &v, sizeof v);
}
inline Float8 all8(float x) { return Float8{} + x; }
template <class V>
inline V larger(V a, V b) {
  return a > b ? a : b;
}
template <class V>
inline V smaller(V a, V b) {
  return a < b ? a : b;
}
// `v`, or none of it, without a branch.
inline Float8 only_if(bool yes, Float8 v) { return (Float8)((Int8)v & (Int8{} - int(yes))); }
inline bool any_above_zero(Float8 v) {
  const FourMasks m = (FourMasks)(v > 0);
  return (m[0] | m[1] | m[2] | m[3]) != 0;
}
inline float largest(Float8 v) {
  const Float8 half = larger(v, __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3)),
               two = larger(half, __builtin_shufflevector(half, half, 2, 3, 0, 1, 6, 7, 4, 5));
  return larger(two[0], two[1]);
}
inline float sum(Float8 v) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}
template <class V>
inline V root(V v) {
  for (std::size_t i = 0; i < sizeof(V) / sizeof(float); ++i) v[i] = std::sqrt(v[i]);
  return v;
}

// Margin of levels above 1 within which a neighbour blocks a section's growth: fully at 1, not at
// all at 1 + kNearLevels. Less: growth makes new contact; more: bellies find no room for their
// volume.
constexpr float kNearLevels = 0.2f;
constexpr float kLeastFactor = 0.1f;  // of an outline, so that levels stay finite

// A level as a quotient.
struct LevelParts {
  Float8 numerator, denominator;
};

// Level of points given in a section's own coordinates: 0 on its centre line, 1 on its outline.
// Eight points of one section (Shape = SectionShape), or of eight sections, one each.
template <class Shape>
inline LevelParts level_parts(const Shape& shape, Float8 x, Float8 y) {
  const auto& w = shape.harmonics;
  const auto& sides = shape.sides;
  x = sides.high_steep * larger(x - sides.high_free, Float8{}) +
      sides.low_steep * smaller(x + sides.low_free, Float8{});
  // The factor times the fourth power of the radius, by powers of x + i y, so that one root and one
  // division do.
  const Float8 xx = x * x, yy = y * y, square = xx + yy + 1e-12f, rho = root(square);
  const Float8 re2 = xx - yy, im2 = 2 * x * y, re3 = re2 * x - im2 * y, im3 = im2 * x + re2 * y,
               re4 = re2 * re2 - im2 * im2, im4 = 2 * re2 * im2;
  const Float8 even = square * (square * w[0] + re2 * w[2] + im2 * w[6]) + re4 * w[4] + im4 * w[8];
  const Float8 odd = square * (x * w[1] + y * w[5]) + re3 * w[3] + im3 * w[7];
  const Float8 fourth = square * square;
  return {rho * fourth, larger(even + rho * odd, kLeastFactor * fourth)};
}
template <class Shape>
inline Float8 level_of(const Shape& shape, Float8 x, Float8 y) {
  const LevelParts parts = level_parts(shape, x, y);
  return parts.numerator / parts.denominator;
}

// Float8 rows become eight columns.
inline void transpose(std::array<Float8, 8>& rows) {
  std::array<Float8, 8> twos, fours;
  for (std::size_t i = 0; i < 8; i += 2) {
    twos[i] = __builtin_shufflevector(rows[i], rows[i + 1], 0, 8, 1, 9, 4, 12, 5, 13);
    twos[i + 1] = __builtin_shufflevector(rows[i], rows[i + 1], 2, 10, 3, 11, 6, 14, 7, 15);
  }
  for (std::size_t i = 0; i < 8; i += 4)
    for (std::size_t k = 0; k < 2; ++k) {
      fours[i + 2 * k] =
          __builtin_shufflevector(twos[i + k], twos[i + k + 2], 0, 1, 8, 9, 4, 5, 12, 13);
      fours[i + 2 * k + 1] =
          __builtin_shufflevector(twos[i + k], twos[i + k + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    }
  for (std::size_t i = 0; i < 4; ++i) {
    rows[i] = __builtin_shufflevector(fours[i], fours[i + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    rows[i + 4] = __builtin_shufflevector(fours[i], fours[i + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
}

}  // namespace ecorche::inline v1
