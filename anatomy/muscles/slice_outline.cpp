#include "anatomy/muscles/slice_outline.h"

#include <cmath>
#include <cstring>
#include <numbers>

namespace ecorche::inline v1 {
namespace {

constexpr std::size_t kCount = kOutlinePoints;

static_assert(kCount % 4 == 0);

// Four directions at once: the compiler keeps them in one register where there is one so wide.
typedef double Quad __attribute__((vector_size(32)));
typedef float FloatQuad __attribute__((vector_size(16)));

// The outline's factors from the one at `i` on; and those from the next on, which after the last is
// the first once more.
inline FloatQuad load(const SliceOutline& outline, std::size_t i) {
  FloatQuad v;
  std::memcpy(&v, outline.data() + i, sizeof v);
  return v;
}
struct Pair {
  Quad at, next;
  Pair(const SliceOutline& outline, std::size_t i) {
    const FloatQuad here = load(outline, i), there = load(outline, (i + 4) % kCount);
    at = __builtin_convertvector(here, Quad);
    next = __builtin_convertvector(__builtin_shufflevector(here, there, 1, 2, 3, 4), Quad);
  }
};

// Products of the coordinates of a direction and the next over the sum of their cross products.
struct Turns {
  Quad xy, yx, xx, yy;
  Quad x, y, next_x, next_y;  // coordinates, over twice the number of directions
};
using AllTurns = std::array<Turns, kCount / 4>;
const AllTurns& turns() {
  static const AllTurns out = [] {
    AllTurns all;
    const auto& d = outline_directions();
    const double whole = kOutlinePoints * std::sin(2 * std::numbers::pi / kOutlinePoints);
    for (std::size_t i = 0; i < kCount; ++i) {
      const std::size_t j = (i + 1) % kCount, k = i % 4;
      Turns& t = all[i / 4];
      t.xy[k] = d[i].x() * d[j].y() / whole;
      t.yx[k] = d[i].y() * d[j].x() / whole;
      t.xx[k] = d[i].x() * d[j].x() / whole;
      t.yy[k] = d[i].y() * d[j].y() / whole;
      t.x[k] = d[i].x() / (2 * kOutlinePoints), t.y[k] = d[i].y() / (2 * kOutlinePoints);
      t.next_x[k] = d[j].x() / (2 * kOutlinePoints), t.next_y[k] = d[j].y() / (2 * kOutlinePoints);
    }
    return all;
  }();
  return out;
}

inline double sum(Quad v) { return (v[0] + v[2]) + (v[1] + v[3]); }

}  // namespace

const std::array<Vec2, kOutlinePoints>& outline_directions() {
  static const std::array<Vec2, kOutlinePoints> directions = [] {
    std::array<Vec2, kOutlinePoints> out;
    for (std::size_t i = 0; i < kCount; ++i) {
      const double angle = 2 * std::numbers::pi * double(i) / kOutlinePoints;
      out[i] = Vec2(std::cos(angle), std::sin(angle));
    }
    return out;
  }();
  return directions;
}

SliceOutline flipped_outline(const SliceOutline& outline, bool width, bool thickness) {
  SliceOutline out;
  for (std::size_t i = 0; i < kCount; ++i) {
    std::size_t from = thickness ? (kCount - i) % kCount : i;
    if (width) from = (kCount + kCount / 2 - from) % kCount;
    out[i] = outline[from];
  }
  return out;
}

double outline_area(const SliceOutline& outline) {
  if (outline == kEllipticOutline) return 1;
  Quad area{};
  for (std::size_t i = 0; i < kCount; i += 4) {
    const Pair f(outline, i);
    area += f.at * f.next;
  }
  return sum(area) / kOutlinePoints;
}

PieceAreas piece_areas(const SliceOutline& first, const SliceOutline& second) {
  if (first == kEllipticOutline && second == kEllipticOutline) return {1, 1, 1, 0, 0, 0, 0, 0, 0};
  const AllTurns& all = turns();
  Quad own{}, ab{}, ba{}, aa{}, bb{}, a1{}, b1{}, a0{}, b0{};
  for (std::size_t i = 0; i < kCount; i += 4) {
    const Turns& t = all[i / 4];
    const Pair f(first, i), g(second, i);
    const Quad f0 = f.at, f1 = f.next, g0 = g.at, g1 = g.next;
    const Quad fg = f0 * g1, gf = g0 * f1, less = fg - gf, of_first = f0 * f1, of_second = g0 * g1;
    own += of_first;
    ab += fg * t.xy - gf * t.yx;
    ba += gf * t.xy - fg * t.yx;
    aa += less * t.xx;
    bb += less * t.yy;
    a1 += of_first * (g0 * t.x + g1 * t.next_x);
    b1 += of_first * (g0 * t.y + g1 * t.next_y);
    a0 += of_second * (f0 * t.x + f1 * t.next_x);
    b0 += of_second * (f0 * t.y + f1 * t.next_y);
  }
  return {sum(own) / kOutlinePoints,
          sum(ab),
          sum(ba),
          sum(aa),
          sum(bb),
          sum(a1),
          sum(b1),
          sum(a0),
          sum(b0)};
}

}  // namespace ecorche::inline v1
