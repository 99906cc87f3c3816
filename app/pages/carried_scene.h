// A person on a mattress or in a sling as a draw list: the skin in the colours of its pressure, the
// sheet, straps, spreader bar and mattress; beside it the skin alone as it is seen from below.
#pragma once

#include <cstdint>
#include <vector>

#include "skinning/lift/lift.h"
#include "viewer/image.h"
#include "viewer/scene.h"

namespace ecorche {

struct CarriedLook {
  double scale = 12e3;       // Pa at the end of the colours
  bool mattress = true;      // is drawn
  Vec3 from_below{0, 0, 0};  // offset of the figure seen from below, m
};

// The colour of a pressure, sRGB: the skin's own at 0, then yellow, red, dark violet; apart in
// lightness, too, so that all eyes tell them.
Vec3f pressure_color(double pressure, double scale);

// A bar of the colours with kPa below it, its upper left corner at (x, y), pixels, as wide as so
// many times the letters' size.
inline constexpr float kPressureLegendWidth = 17;
void draw_pressure_legend(Image& image, float x, float y, float size, double scale);

// Sets meshes, items, light and background; the camera stays.
void carried_scene(const CarryModel& model, const LiftFrame& frame, const CarriedLook& look,
                   std::uint64_t revision, DrawList& list);

// A camera beside the lying body that has both figures of these frames in view. aspect: width over
// height.
Camera carried_camera(const CarryModel& model, const std::vector<LiftFrame>& frames,
                      const CarriedLook& look, float aspect);

// Where the second figure goes: beyond the feet of the first.
Vec3 beside_the_feet(const std::vector<LiftFrame>& frames);

}  // namespace ecorche
