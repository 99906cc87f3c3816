#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/contact_lanes.h"

namespace ecorche {
namespace {

constexpr std::size_t kCount = kOutlinePoints, kSpokes = kContactPoints;

constexpr float kSheetFree = 0.8f;    // of the half width: from there on a sheet's strip leaves off beside the next one,
constexpr float kSheetSteep = 4;      // so many times as fast
constexpr int kRoomDirections = 64;
constexpr float kRoomMargin = 1.02f;  // for what lies between them,
constexpr float kFewMargin = 1.06f;   // or between the outline's own

struct Directions {
  SliceOutline cosine, sine;
};
const Directions kDirections = [] {
  Directions out;
  for (std::size_t i = 0; i < kCount; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kCount;
    out.cosine[i] = static_cast<float>(std::cos(angle));
    out.sine[i] = static_cast<float>(std::sin(angle));
  }
  return out;
}();

OutlineWaves outline_waves(const SliceOutline& outline) {
  OutlineWaves out{};
  for (std::size_t i = 0; i < kCount; ++i) {
    const float f = outline[i] / static_cast<float>(kCount);
    out[0] += f;
    for (std::size_t n = 1; n <= kHarmonics; ++n) {
      out[n] += 2 * f * kDirections.cosine[n * i % kCount];
      out[kHarmonics + n] += 2 * f * kDirections.sine[n * i % kCount];
    }
  }
  return out;
}

// What a section asks others with.
void set_spokes(const SliceOutline& outline, ContactShape& out) {
  out.box = {0, 0, 0, 0};
  for (std::size_t i = 0; i < kSpokes; ++i) {
    const float x = out.along_width[i] = outline[2 * i] * kDirections.cosine[2 * i], y = out.along_thickness[i] = outline[2 * i] * kDirections.sine[2 * i];
    out.box = {std::max(out.box.right, x), std::max(out.box.left, -x), std::max(out.box.up, y), std::max(out.box.down, -y)};
  }
}

void add_room(float x, float y, OutlineBox& room) {
  room = {std::max(room.right, x), std::max(room.left, -x), std::max(room.up, y), std::max(room.down, -y)};
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
    const Eight x = sign * load(kDirections.cosine.data()), y = sign * load(kDirections.sine.data());
    const Eight far = kFewMargin * (1 + kNearLevels) / level_of(out, x, y);
    for (std::size_t i = 0; i < kSpokes; ++i) add_room(far[i] * x[i], far[i] * y[i], out.room);
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
    const float c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    const float far = kRoomMargin * (1 + kNearLevels) / level_of(out, all(c), all(s))[0];
    add_room(far * c, far * s, out.room);
  }
  if (sides & 1) out.sides.low_free = kSheetFree, out.sides.low_steep = kSheetSteep;
  if (sides & 2) out.sides.high_free = kSheetFree, out.sides.high_steep = kSheetSteep;
  narrow_room(out.sides, out.room);
  return out;
}

}  // namespace ecorche
