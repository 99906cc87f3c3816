// Legends on pictures: colours of muscles, and scale bars.
#pragma once

#include "viewer/image.h"
#include "viewer/scene.h"

namespace ecorche {

// A bar of the muscles' colours from stretched to shortened, or relaxed to full effort, its upper
// left corner at (x, y), pixels. size: of the letters, pixels. Returns its width.
float draw_muscle_legend(Image& image, float x, float y, float size, MuscleColors colors);

// A bar of `metres` with its length written over it, its left end at (x, y).
void draw_scale_bar(Image& image, float x, float y, float size, float pixels_per_metre,
                    float metres);

}  // namespace ecorche
