// Antialiased text, lines and rectangles drawn over finished pictures.
#pragma once

#include <string_view>

#include "viewer/draw_list.h"
#include "viewer/image.h"

namespace ecorche {

enum class Align { left, center, right };

struct TextStyle {
  float size = 18;                   // pixels from one line to the next, less the leading
  Vec3f color{0.13f, 0.13f, 0.14f};  // sRGB
  float opacity = 1;
  Align align = Align::left;
};

// Draws one line of UTF-8 text with its baseline at y (pixels from the top), clipped to the
// picture. Without the font file (Debian's fonts-dejavu-core) nothing is drawn and widths are 0.
void draw_text(Image& image, std::string_view text, float x, float y, const TextStyle& style = {});
float text_width(std::string_view text, float size);

void draw_line(Image& image, float x0, float y0, float x1, float y1, float width,
               const Vec3f& color, float opacity = 1);

// Fills the rectangle [x, x + width] x [y, y + height].
void fill_field(Image& image, float x, float y, float width, float height, const Vec3f& color,
                float opacity = 1);

}  // namespace ecorche
