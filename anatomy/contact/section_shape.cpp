#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/contact/section_levels.h"

namespace ecorche {
namespace {

constexpr std::size_t kCount = kOutlinePoints;

// of the half width: from there on a sheet's strip leaves off beside the next one,
constexpr float kSheetFree = 0.8f;
constexpr float kSheetSteep = 4;  // so many times as fast
constexpr int kRoomDirections = 64;
constexpr float kRoomMargin = 1.02f;  // for what lies between them,
constexpr float kFewMargin = 1.06f;   // or between the outline's own

struct Directions {
  SliceOutline cosine, sine;
};
const Directions kDirections = [] {
  Directions out;
  for (std::size_t i = 0; i < kCount; ++i) {
    const double angle = 2 * std::numbers::pi * double(i) / kCount;
    out.cosine[i] = float(std::cos(angle));
    out.sine[i] = float(std::sin(angle));
  }
  return out;
}();

// Of one direction: what twice its share of the factors adds to each wave. Nine of them: eight at
// once, and the last.
struct WavesOfOne {
  std::array<float, 8> first;
  float last;
};
const std::array<WavesOfOne, kCount> kWaves = [] {
  std::array<WavesOfOne, kCount> out;
  for (std::size_t i = 0; i < kCount; ++i) {
    const auto angle = [&](std::size_t n) { return n * i % kCount; };
    out[i] = {{0.5f, kDirections.cosine[angle(1)], kDirections.cosine[angle(2)],
               kDirections.cosine[angle(3)], kDirections.cosine[angle(4)],
               kDirections.sine[angle(1)], kDirections.sine[angle(2)], kDirections.sine[angle(3)]},
              kDirections.sine[angle(4)]};
  }
  return out;
}();

OutlineWaves outline_waves(const SliceOutline& outline) {
  static_assert(kHarmonics == 4);
  Eight first{};
  float last = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    const float f = 2 * (outline[i] / float(kCount));
    first += f * load(kWaves[i].first.data());
    last += f * kWaves[i].last;
  }
  OutlineWaves out;
  store(first, out.data());
  out.back() = last;
  return out;
}

inline Eight every_second(const float* from) {
  return __builtin_shufflevector(load(from), load(from + 8), 0, 2, 4, 6, 8, 10, 12, 14);
}

inline OutlineBox box_of(Eight x, Eight y) {
  const Eight none{};
  return {largest(larger(x, none)), largest(larger(-x, none)), largest(larger(y, none)),
          largest(larger(-y, none))};
}

// What a section asks others with.
void set_spokes(const SliceOutline& outline, ContactShape& out) {
  const Eight factors = every_second(outline.data());
  const Eight x = factors * every_second(kDirections.cosine.data()),
              y = factors * every_second(kDirections.sine.data());
  store(x, out.along_width.data());
  store(y, out.along_thickness.data());
  out.box = box_of(x, y);
}

inline void add_room(const OutlineBox& more, OutlineBox& room) {
  room = {std::max(room.right, more.right), std::max(room.left, more.left),
          std::max(room.up, more.up), std::max(room.down, more.down)};
}

// The room of a tube that leaves off beside its sheet's next strip.
void narrow_room(const SheetSides& sides, OutlineBox& room) {
  if (sides.low_steep != 1) room.left = sides.low_free + room.left / sides.low_steep;
  if (sides.high_steep != 1) room.right = sides.high_free + room.right / sides.high_steep;
}

}  // namespace

void reshape(const SheetSides& sides, const SliceOutline& outline, ContactShape& out) {
  out.waves = outline_waves(outline);
  set_spokes(outline, out);
  out.room = {0, 0, 0, 0};
  out.sides = {};
  for (const float sign : {1.0f, -1.0f}) {
    const Eight x = sign * load(kDirections.cosine.data()),
                y = sign * load(kDirections.sine.data());
    const Eight far = kFewMargin * (1 + kNearLevels) / level_of(out, x, y);
    add_room(box_of(far * x, far * y), out.room);
  }
  out.sides = sides;
  narrow_room(sides, out.room);
}

ContactShape contact_shape(const SliceOutline& outline, int sides) {
  ContactShape out;
  out.waves = outline_waves(outline);
  set_spokes(outline, out);
  out.room = {0, 0, 0, 0};
  for (int i = 0; i < kRoomDirections; ++i) {
    const double angle = 2 * std::numbers::pi * i / kRoomDirections;
    const float c = float(std::cos(angle)), s = float(std::sin(angle));
    const float far = kRoomMargin * (1 + kNearLevels) / level_of(out, all(c), all(s))[0];
    add_room(box_of(all(far * c), all(far * s)), out.room);
  }
  if (sides & 1) out.sides.low_free = kSheetFree, out.sides.low_steep = kSheetSteep;
  if (sides & 2) out.sides.high_free = kSheetFree, out.sides.high_steep = kSheetSteep;
  narrow_room(out.sides, out.room);
  return out;
}

}  // namespace ecorche
