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

LopsidedMoments lopsided_moments(const SliceOutline& first, const SliceOutline& second) {
  if (first == kEllipticOutline && second == kEllipticOutline) return {};
  const auto& d = outline_directions();
  Vec2 by_first = Vec2::Zero(), by_second = Vec2::Zero();
  for (std::size_t i = 0; i < kCount; ++i) {
    const std::size_t j = (i + 1) % kCount;
    const Vec2 f0 = static_cast<double>(first[i]) * d[i], f1 = static_cast<double>(first[j]) * d[j];
    const Vec2 g0 = static_cast<double>(second[i]) * d[i], g1 = static_cast<double>(second[j]) * d[j];
    by_first += (f0.x() * f1.y() - f0.y() * f1.x()) * (g0 + g1) / 2;
    by_second += (g0.x() * g1.y() - g0.y() * g1.x()) * (f0 + f1) / 2;
  }
  const double whole = kOutlinePoints * turn_sine();
  return {by_first.x() / whole, by_first.y() / whole, by_second.x() / whole, by_second.y() / whole};
}

}  // namespace ecorche
