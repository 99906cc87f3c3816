#include "app/pages/legend.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "viewer/lettering.h"

namespace ecorche {

float draw_muscle_legend(Image& image, float x, float y, float size, MuscleColors colors) {
  constexpr int steps = 64;
  const float width = 17 * size, bar = 0.55f * size, top = y + 1.5f * size;
  const bool effort = colors == MuscleColors::activation;
  for (int i = 0; i < steps; ++i)
    fill_field(
        image, x + width * float(i) / steps, top, width / steps + 0.5f, bar,
        muscle_color(colors, (effort ? 1 : 2) * (float(i) + 0.5f) / steps - (effort ? 0 : 1)));
  draw_text(image, effort ? "muscle activation" : "muscle length", x, y + size, {.size = size});
  const float baseline = top + bar + 1.05f * size;
  draw_text(image, effort ? "relaxed" : "20 % longer", x, baseline, {.size = 0.85f * size});
  draw_text(image, effort ? "50 %" : "at rest", x + 0.5f * width, baseline,
            {.size = 0.85f * size, .align = Align::center});
  draw_text(image, effort ? "full effort" : "20 % shorter", x + width, baseline,
            {.size = 0.85f * size, .align = Align::right});
  return width;
}

void draw_scale_bar(Image& image, float x, float y, float size, float pixels_per_metre,
                    float metres) {
  const Vec3f ink = TextStyle{}.color;
  const float width = metres * pixels_per_metre, line = std::max(1.0f, 0.1f * size),
              tick = 0.3f * size;
  draw_line(image, x, y, x + width, y, line, ink);
  for (const float end : {x, x + width}) draw_line(image, end, y - tick, end, y + tick, line, ink);
  draw_text(image,
            metres < 1 ? fmt::format("{:.0f} cm", 100 * metres) : fmt::format("{:.2g} m", metres),
            x + 0.5f * width, y - 0.5f * size, {.size = size, .align = Align::center});
}

}  // namespace ecorche
