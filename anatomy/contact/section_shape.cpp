#include "anatomy/contact/section_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/contact/section_levels.h"

namespace ecorche::inline v1 {
namespace {

constexpr std::size_t kCountSectionShape = kOutlinePoints;

// Edge of a sheet's strip beside the next one: share of the half width from which the level rises
// faster, and how many times as fast. The drawn sheet goes on there, so no vertex follows the
// strip's own outline.
constexpr float kSheetFree = 0.8f;
constexpr float kSheetSteep = 4;
// Directions in which the reach of a rest outline is sampled, and factors for what lies between
// them, or between the outline's own directions.
constexpr int kReachDirections = 64;
constexpr float kReachMargin = 1.02f;
constexpr float kCoarseReachMargin = 1.06f;

struct Directions {
  SliceOutline cosine, sine;
};
const Directions kDirections = [] {
  Directions out;
  for (std::size_t i = 0; i < kCountSectionShape; ++i) {
    const double angle = 2 * std::numbers::pi * double(i) / kCountSectionShape;
    out.cosine[i] = float(std::cos(angle));
    out.sine[i] = float(std::sin(angle));
  }
  return out;
}();

// Of one direction: what twice its part of the factors adds to each harmonic. Nine of them: eight
// at once, and the last.
struct HarmonicsOfOne {
  std::array<float, 8> first;
  float last;
};
const std::array<HarmonicsOfOne, kCountSectionShape> kOutlineBasis = [] {
  std::array<HarmonicsOfOne, kCountSectionShape> out;
  for (std::size_t i = 0; i < kCountSectionShape; ++i) {
    const auto angle = [&](std::size_t n) { return n * i % kCountSectionShape; };
    out[i] = {{0.5f, kDirections.cosine[angle(1)], kDirections.cosine[angle(2)],
               kDirections.cosine[angle(3)], kDirections.cosine[angle(4)],
               kDirections.sine[angle(1)], kDirections.sine[angle(2)], kDirections.sine[angle(3)]},
              kDirections.sine[angle(4)]};
  }
  return out;
}();

OutlineHarmonics outline_harmonics(const SliceOutline& outline) {
  static_assert(kHarmonics == 4);
  Float8 first{};
  float last = 0;
  for (std::size_t i = 0; i < kCountSectionShape; ++i) {
    const float f = 2 * (outline[i] / float(kCountSectionShape));
    first += f * load8(kOutlineBasis[i].first.data());
    last += f * kOutlineBasis[i].last;
  }
  OutlineHarmonics out;
  store(first, out.data());
  out.back() = last;
  return out;
}

inline Float8 every_second(const float* from) {
  return __builtin_shufflevector(load8(from), load8(from + 8), 0, 2, 4, 6, 8, 10, 12, 14);
}

inline OutlineBox box_of(Float8 x, Float8 y) {
  const Float8 none{};
  return {largest(larger(x, none)), largest(larger(-x, none)), largest(larger(y, none)),
          largest(larger(-y, none))};
}

// Sample points by which a section probes others.
void set_samples(const SliceOutline& outline, SectionShape& out) {
  const Float8 factors = every_second(outline.data());
  const Float8 x = factors * every_second(kDirections.cosine.data()),
               y = factors * every_second(kDirections.sine.data());
  store(x, out.along_width.data());
  store(y, out.along_thickness.data());
  out.box = box_of(x, y);
}

inline void extend(const OutlineBox& more, OutlineBox& reach) {
  reach = {std::max(reach.right, more.right), std::max(reach.left, more.left),
           std::max(reach.up, more.up), std::max(reach.down, more.down)};
}

// The reach of a strip that ends beside the next one of its sheet.
void narrow_reach(const SheetSides& sides, OutlineBox& reach) {
  if (sides.low_steep != 1) reach.left = sides.low_free + reach.left / sides.low_steep;
  if (sides.high_steep != 1) reach.right = sides.high_free + reach.right / sides.high_steep;
}

}  // namespace

void update_section_shape(const SheetSides& sides, const SliceOutline& outline, SectionShape& out) {
  out.harmonics = outline_harmonics(outline);
  set_samples(outline, out);
  out.reach = {0, 0, 0, 0};
  out.sides = {};
  for (const float sign : {1.0f, -1.0f}) {
    const Float8 x = sign * load8(kDirections.cosine.data()),
                 y = sign * load8(kDirections.sine.data());
    const Float8 far = kCoarseReachMargin * (1 + kNearLevels) / level_of(out, x, y);
    extend(box_of(far * x, far * y), out.reach);
  }
  out.sides = sides;
  narrow_reach(sides, out.reach);
}

SectionShape section_shape(const SliceOutline& outline, int sides) {
  SectionShape out;
  out.harmonics = outline_harmonics(outline);
  set_samples(outline, out);
  out.reach = {0, 0, 0, 0};
  for (int i = 0; i < kReachDirections; ++i) {
    const double angle = 2 * std::numbers::pi * i / kReachDirections;
    const float c = float(std::cos(angle)), s = float(std::sin(angle));
    const float far = kReachMargin * (1 + kNearLevels) / level_of(out, all8(c), all8(s))[0];
    extend(box_of(all8(far * c), all8(far * s)), out.reach);
  }
  if (sides & 1) out.sides.low_free = kSheetFree, out.sides.low_steep = kSheetSteep;
  if (sides & 2) out.sides.high_free = kSheetFree, out.sides.high_steep = kSheetSteep;
  narrow_reach(out.sides, out.reach);
  return out;
}

}  // namespace ecorche::inline v1
