// Pixels of the window, kept to be put back where they have not changed.
//
// A store's rows lie as the window's own do, from the top, so that a driver without a graphics card
// moves memory in place of drawing.
#pragma once

#include "viewer/gl/gl_api.h"
#include "viewer/gl/gl_targets.h"

namespace ecorche {

// Pixels from the upper left.
struct PixelBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

// `store` has the window's size and the format GL_RGBA. Both leave the window bound.
void keep_pixels(const GlApi& gl, const PixelBox& box, const GlTarget& store);
void put_pixels(const GlApi& gl, const PixelBox& box, const GlTarget& store);

}  // namespace ecorche
