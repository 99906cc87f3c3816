#include "anatomy/outline.h"

#include <cmath>
#include <numbers>

namespace ecorche {
namespace {

constexpr std::size_t kCount = kOutlinePoints;

double turn_sine() {
  static const double sine = std::sin(2 * std::numbers::pi / kOutlinePoints);
  return sine;
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
  double sum = 0;
  for (std::size_t i = 0; i < kCount; ++i) sum += static_cast<double>(outline[i]) * static_cast<double>(outline[(i + 1) % kCount]);
  return sum / kOutlinePoints;
}

MixedArea mixed_area(const SliceOutline& first, const SliceOutline& second) {
  if (first == kEllipticOutline && second == kEllipticOutline) return {};
  const auto& d = outline_directions();
  MixedArea out{0, 0, 0, 0};
  for (std::size_t i = 0; i < kCount; ++i) {
    const std::size_t j = (i + 1) % kCount;
    const double fg = static_cast<double>(first[i]) * static_cast<double>(second[j]), gf = static_cast<double>(second[i]) * static_cast<double>(first[j]);
    const double cs = d[i].x() * d[j].y(), sc = d[i].y() * d[j].x();
    out.ab += fg * cs - gf * sc;
    out.ba += gf * cs - fg * sc;
    out.aa += (fg - gf) * d[i].x() * d[j].x();
    out.bb += (fg - gf) * d[i].y() * d[j].y();
  }
  const double whole = kOutlinePoints * turn_sine();
  return {out.ab / whole, out.ba / whole, out.aa / whole, out.bb / whole};
}

}  // namespace ecorche
