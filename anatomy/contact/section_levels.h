// Eight directions of an outline at once, and the level of points in a section. Private to posed
// contact.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "anatomy/contact/muscle_contact.h"

namespace ecorche {

// Eight directions at once, or the three measures: the compiler keeps them in one register where
// there is one so wide.
typedef float Eight __attribute__((vector_size(32)));
typedef float Four __attribute__((vector_size(16)));
typedef std::int32_t EightMasks __attribute__((vector_size(32)));
typedef std::int64_t FourMasks __attribute__((vector_size(32)));
typedef std::int64_t TwoMasks __attribute__((vector_size(16)));
static_assert(sizeof(Eight) == sizeof(ContactSpokes));

template <class V>
inline V load_as(const float* p) {
  V v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline Eight load(const float* p) { return load_as<Eight>(p); }
template <class V>
inline void store(V v, float* p) {
  std::memcpy(p, &v, sizeof v);
}
inline Eight all(float x) { return Eight{} + x; }
template <class V>
inline V larger(V a, V b) {
  return a > b ? a : b;
}
template <class V>
inline V smaller(V a, V b) {
  return a < b ? a : b;
}
// `v`, or none of it, without a branch.
inline Eight only_if(bool yes, Eight v) {
  return (Eight)((EightMasks)v & (EightMasks{} - std::int32_t(yes)));
}
inline bool any_above_zero(Eight v) {
  const FourMasks m = (FourMasks)(v > 0);
  return (m[0] | m[1] | m[2] | m[3]) != 0;
}
inline float largest(Eight v) {
  const Eight half = larger(v, __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3)),
              two = larger(half, __builtin_shufflevector(half, half, 2, 3, 0, 1, 6, 7, 4, 5));
  return larger(two[0], two[1]);
}
inline float sum(Eight v) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}
template <class V>
inline V root(V v) {
  for (std::size_t i = 0; i < sizeof(V) / sizeof(float); ++i) v[i] = std::sqrt(v[i]);
  return v;
}

// levels above 1 at which a neighbour keeps a section from growing
constexpr float kNearLevels = 0.2f;
constexpr float kLeastFactor = 0.1f;  // of an outline

// Parts of a level: it is their quotient.
struct LevelParts {
  Eight over, under;
};

// Level of points given in a section's own measures: 0 on its line, 1 on its outline. Of one
// section's, by its ContactShape's waves and sides, or of eight sections, one each.
template <class Shape>
inline LevelParts level_parts(const Shape& shape, Eight x, Eight y) {
  const auto& w = shape.waves;
  const auto& sides = shape.sides;
  x = sides.high_steep * larger(x - sides.high_free, Eight{}) +
      sides.low_steep * smaller(x + sides.low_free, Eight{});
  // The factor times the fourth power of the radius, by powers of x + i y, so that one root and one
  // division do.
  const Eight xx = x * x, yy = y * y, square = xx + yy + 1e-12f, rho = root(square);
  const Eight re2 = xx - yy, im2 = 2 * x * y, re3 = re2 * x - im2 * y, im3 = im2 * x + re2 * y,
              re4 = re2 * re2 - im2 * im2, im4 = 2 * re2 * im2;
  const Eight even = square * (square * w[0] + re2 * w[2] + im2 * w[6]) + re4 * w[4] + im4 * w[8];
  const Eight odd = square * (x * w[1] + y * w[5]) + re3 * w[3] + im3 * w[7];
  const Eight fourth = square * square;
  return {rho * fourth, larger(even + rho * odd, kLeastFactor * fourth)};
}
template <class Shape>
inline Eight level_of(const Shape& shape, Eight x, Eight y) {
  const LevelParts parts = level_parts(shape, x, y);
  return parts.over / parts.under;
}

// Eight rows become eight columns.
inline void transpose(std::array<Eight, 8>& rows) {
  std::array<Eight, 8> twos, fours;
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

// A section's shape with another outline than at rest.
void reshape(const SheetSides& sides, const SliceOutline& outline, ContactShape& out);

}  // namespace ecorche
