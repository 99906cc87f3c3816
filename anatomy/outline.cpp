#include "anatomy/outline.h"

#include <cmath>
#include <numbers>

namespace ecorche {
namespace {

constexpr std::size_t kCount = kOutlinePoints;

// All directions at once.
using Around = Eigen::Array<double, kOutlinePoints, 1>;

// A factor, and that of the next direction.
struct Factors {
  Around here, next;
  explicit Factors(const SliceOutline& outline) {
    here = Eigen::Map<const Eigen::Array<float, kOutlinePoints, 1>>(outline.data()).cast<double>();
    next << here.tail<kOutlinePoints - 1>(), here[0];
  }
};

// Products of the coordinates of a direction and the next over the sum of their cross products.
struct Turns {
  Around xy, yx, xx, yy;
  Around x, y, next_x, next_y;  // coordinates alone
};
const Turns& turns() {
  static const Turns out = [] {
    Turns t;
    const auto& d = outline_directions();
    const double whole = kOutlinePoints * std::sin(2 * std::numbers::pi / kOutlinePoints);
    for (std::size_t i = 0; i < kCount; ++i) {
      const std::size_t j = (i + 1) % kCount;
      const auto k = static_cast<Eigen::Index>(i);
      t.xy[k] = d[i].x() * d[j].y() / whole;
      t.yx[k] = d[i].y() * d[j].x() / whole;
      t.xx[k] = d[i].x() * d[j].x() / whole;
      t.yy[k] = d[i].y() * d[j].y() / whole;
      t.x[k] = d[i].x(), t.y[k] = d[i].y();
      t.next_x[k] = d[j].x(), t.next_y[k] = d[j].y();
    }
    return t;
  }();
  return out;
}

}  // namespace

const std::array<Vec2, kOutlinePoints>& outline_directions() {
  static const std::array<Vec2, kOutlinePoints> directions = [] {
    std::array<Vec2, kOutlinePoints> out;
    for (std::size_t i = 0; i < kCount; ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kOutlinePoints;
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
  const Factors f(outline);
  return (f.here * f.next).sum() / kOutlinePoints;
}

MixedArea mixed_area(const SliceOutline& first, const SliceOutline& second) {
  if (first == kEllipticOutline && second == kEllipticOutline) return {};
  const Turns& t = turns();
  const Factors f(first), g(second);
  const Around fg = f.here * g.next, gf = g.here * f.next, less = fg - gf;
  return {(fg * t.xy - gf * t.yx).sum(), (gf * t.xy - fg * t.yx).sum(), (less * t.xx).sum(), (less * t.yy).sum()};
}

LopsidedMoments lopsided_moments(const SliceOutline& first, const SliceOutline& second) {
  if (first == kEllipticOutline && second == kEllipticOutline) return {};
  const Turns& t = turns();
  const Factors f(first), g(second);
  const Around of_first = f.here * f.next / (2 * kOutlinePoints), of_second = g.here * g.next / (2 * kOutlinePoints);
  return {(of_first * (g.here * t.x + g.next * t.next_x)).sum(), (of_first * (g.here * t.y + g.next * t.next_y)).sum(),
          (of_second * (f.here * t.x + f.next * t.next_x)).sum(), (of_second * (f.here * t.y + f.next * t.next_y)).sum()};
}

}  // namespace ecorche
