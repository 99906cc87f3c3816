#include "viewer/image.h"

#include <png.h>

#include <csetjmp>
#include <string_view>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"

namespace ecorche {
namespace {

void append(png_structp png, png_bytep data, png_size_t size) {
  auto& out = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(png));
  out.insert(out.end(), data, data + size);
}

void flush(png_structp) {}

// libpng reports by longjmp: nothing with a destructor may be born between here and the return.
bool encode(const Image& image, png_bytepp rows, std::vector<std::uint8_t>& out) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (!info || setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_write_fn(png, &out, append, flush);
  png_set_compression_level(png, 4);
  png_set_IHDR(png, info, image.width, image.height, 8,
               image.transparent ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(png, info);
  if (!image.transparent) png_set_filler(png, 0, PNG_FILLER_AFTER);
  png_write_image(png, rows);
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return true;
}

}  // namespace

Image make_image(int width, int height, std::uint8_t grey) {
  return {width, height, std::vector<std::uint8_t>(4 * std::size_t(width) * height, grey), false};
}

std::vector<std::uint8_t> encode_png(const Image& image) {
  std::vector<png_bytep> rows(image.height);
  for (int y = 0; y < image.height; ++y) rows[y] = const_cast<png_bytep>(image.pixel(0, y));
  std::vector<std::uint8_t> bytes;
  if (!encode(image, rows.data(), bytes)) throw OutputError("PNG: could not encode the picture");
  return bytes;
}

void write_png(const std::filesystem::path& file, const Image& image) {
  const std::vector<std::uint8_t> bytes = encode_png(image);
  write_file_atomically(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace ecorche
