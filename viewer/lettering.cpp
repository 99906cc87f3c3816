#include "viewer/lettering.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#define STB_TRUETYPE_IMPLEMENTATION
#define STBTT_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_truetype.h>
#pragma GCC diagnostic pop

namespace ecorche {
namespace {

constexpr const char* font_file = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

struct Font {
  std::string bytes;
  stbtt_fontinfo info{};
  bool good = false;

  Font() {
    std::ifstream in(font_file, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
    good = bytes.size() > 12 &&
           stbtt_InitFont(&info, reinterpret_cast<const unsigned char*>(bytes.data()), 0) != 0;
  }
};

// Read once, at the first letter.
const Font& font() {
  static const Font one;
  return one;
}

// The next character of UTF-8 text; malformed bytes count as one character each.
int next_character(std::string_view& text) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
  };
  const unsigned first = byte(0);
  const int more = first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : first >= 0xc0 ? 1 : 0;
  unsigned code = more == 0 ? first : first & (0x3fu >> more);
  for (int i = 1; i <= more; ++i) {
    if ((byte(i) & 0xc0u) != 0x80u) {
      text.remove_prefix(1);
      return int(first);
    }
    code = (code << 6) | (byte(i) & 0x3fu);
  }
  text.remove_prefix(more + 1);
  return int(code);
}

void blend(Image& image, int x, int y, const Vec3f& color, float share) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height || share <= 0) return;
  std::uint8_t* p = image.pixel(x, y);
  for (int k = 0; k < 3; ++k)
    p[k] = std::uint8_t(std::lround(p[k] + std::min(share, 1.0f) *
                                               (255 * std::clamp(color[k], 0.0f, 1.0f) - p[k])));
}

}  // namespace

float text_width(std::string_view text, float size) {
  if (!font().good) return 0;
  const float scale = stbtt_ScaleForPixelHeight(&font().info, size);
  float width = 0;
  while (!text.empty()) {
    int advance = 0, bearing = 0;
    stbtt_GetCodepointHMetrics(&font().info, next_character(text), &advance, &bearing);
    width += scale * float(advance);
  }
  return width;
}

void draw_text(Image& image, std::string_view text, float x, float y, const TextStyle& style) {
  if (!font().good) return;
  const stbtt_fontinfo* info = &font().info;
  const float scale = stbtt_ScaleForPixelHeight(info, style.size);
  if (style.align != Align::left)
    x -= text_width(text, style.size) * (style.align == Align::center ? 0.5f : 1.0f);
  std::vector<unsigned char> mask;
  while (!text.empty()) {
    const int character = next_character(text);
    int advance = 0, bearing = 0, x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    stbtt_GetCodepointHMetrics(info, character, &advance, &bearing);
    const float shift = x - std::floor(x);
    stbtt_GetCodepointBitmapBoxSubpixel(info, character, scale, scale, shift, 0, &x0, &y0, &x1,
                                        &y1);
    const int w = x1 - x0, h = y1 - y0;
    if (w > 0 && h > 0) {
      mask.assign(std::size_t(w) * h, 0);
      stbtt_MakeCodepointBitmapSubpixel(info, mask.data(), w, h, w, scale, scale, shift, 0,
                                        character);
      for (int row = 0; row < h; ++row)
        for (int column = 0; column < w; ++column)
          blend(image, int(std::floor(x)) + x0 + column, int(std::lround(y)) + y0 + row,
                style.color, style.opacity * float(mask[row * w + column]) / 255);
    }
    x += scale * float(advance);
  }
}

void draw_line(Image& image, float x0, float y0, float x1, float y1, float width,
               const Vec3f& color, float opacity) {
  const float dx = x1 - x0, dy = y1 - y0, length2 = std::max(dx * dx + dy * dy, 1e-12f),
              reach = 0.5f * width + 1;
  for (int y = std::floor(std::min(y0, y1) - reach); y <= std::max(y0, y1) + reach; ++y)
    for (int x = std::floor(std::min(x0, x1) - reach); x <= std::max(x0, x1) + reach; ++x) {
      const float px = float(x) + 0.5f - x0, py = float(y) + 0.5f - y0;
      const float t = std::clamp((px * dx + py * dy) / length2, 0.0f, 1.0f);
      blend(image, x, y, color,
            opacity *
                std::clamp(0.5f + 0.5f * width - std::hypot(px - t * dx, py - t * dy), 0.0f, 1.0f));
    }
}

void fill_field(Image& image, float x, float y, float width, float height, const Vec3f& color,
                float opacity) {
  const auto covered = [](float low, float high, int at) {
    return std::clamp(std::min(high, float(at) + 1) - std::max(low, float(at)), 0.0f, 1.0f);
  };
  for (int row = std::floor(y); row < y + height; ++row)
    for (int column = std::floor(x); column < x + width; ++column)
      blend(image, column, row, color,
            opacity * covered(x, x + width, column) * covered(y, y + height, row));
}

}  // namespace ecorche
