// Pictures in memory and on disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace ecorche {

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t>
      rgba;                  // top row first, 4 bytes a pixel, sRGB; not multiplied by the opacity
  bool transparent = false;  // the fourth byte is the opacity; otherwise it is ignored

  std::uint8_t* pixel(int x, int y) { return rgba.data() + 4 * (std::size_t(y) * width + x); }
  const std::uint8_t* pixel(int x, int y) const {
    return rgba.data() + 4 * (std::size_t(y) * width + x);
  }
};

Image make_image(int width, int height, std::uint8_t grey = 255);

// 8-bit RGB PNG (alpha is left away), the same bytes for the same picture. Throws OutputError
// naming the file.
void write_png(const std::filesystem::path& file, const Image& image);

// Bytes of that PNG file.
std::vector<std::uint8_t> encode_png(const Image& image);

}  // namespace ecorche
