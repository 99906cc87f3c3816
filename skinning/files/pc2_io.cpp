#include "skinning/files/pc2_io.h"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

static_assert(std::endian::native == std::endian::little, "PC2 is written as it lies in memory");

struct Header {
  char magic[12] = {'P', 'O', 'I', 'N', 'T', 'C', 'A', 'C', 'H', 'E', '2', '\0'};
  std::int32_t version = 1, points = 0;
  float start_frame = 0, frame_step = 1;
  std::int32_t frames = 0;
};
static_assert(sizeof(Header) == 32);

}  // namespace

Pc2Writer::Pc2Writer(std::filesystem::path path, int point_count, float start_frame,
                     float frame_step)
    : path_(std::move(path)), file_(path_), points_(point_count) {
  if (point_count <= 0) throw std::invalid_argument("Pc2Writer: a cache needs at least one point");
  Header header;
  header.points = point_count;
  header.start_frame = start_frame;
  header.frame_step = frame_step;
  file_.stream().write(reinterpret_cast<const char*>(&header), sizeof header);
  row_.resize(3 * std::size_t(points_));
}

void Pc2Writer::add_frame(std::span<const float> positions, int stride) {
  if (stride < 3 || positions.size() < std::size_t(points_) * std::size_t(stride))
    throw std::invalid_argument(
        fmt::format("Pc2Writer: {} floats do not hold {} points", positions.size(), points_));
  const std::size_t step = stride;
  for (std::size_t i = 0; i < std::size_t(points_); ++i)
    std::memcpy(&row_[3 * i], &positions[i * step], 12);
  file_.stream().write(reinterpret_cast<const char*>(row_.data()),
                       std::streamsize(row_.size() * sizeof(float)));
  if (!file_.stream()) file_.fail();
  ++frames_;
}

void Pc2Writer::finish() {
  file_.stream().seekp(offsetof(Header, frames));
  file_.stream().write(reinterpret_cast<const char*>(&frames_), sizeof frames_);
  file_.commit();
}

Pc2Cache read_pc2(const std::filesystem::path& path, std::uint64_t max_bytes) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("{}: cannot be opened", path.string()));
  Header header;
  const Header expected;
  file.read(reinterpret_cast<char*>(&header), sizeof header);
  if (!file || std::memcmp(header.magic, expected.magic, sizeof header.magic) != 0 ||
      header.version != 1)
    throw InputError(fmt::format("{}: not a PC2 point cache of version 1", path.string()));
  if (header.points <= 0 || header.frames < 0)
    throw InputError(fmt::format("{}: {} points in {} samples make no cache", path.string(),
                                 header.points, header.frames));
  const std::uint64_t row = 12 * std::uint64_t(header.points);
  const std::uint64_t bytes = row * std::uint64_t(header.frames);
  if (std::filesystem::file_size(path) < sizeof header + bytes)
    throw InputError(fmt::format("{}: ends before its {} samples of {} points", path.string(),
                                 header.frames, header.points));
  if (bytes > max_bytes)
    throw LimitError(
        fmt::format("{}: {} bytes of samples, the limit is {}", path.string(), bytes, max_bytes));
  Pc2Cache cache{header.points, header.start_frame, header.frame_step, {}};
  cache.frames.resize(header.frames);
  for (std::vector<float>& frame : cache.frames) {
    frame.resize(3 * std::size_t(header.points));
    file.read(reinterpret_cast<char*>(frame.data()), std::streamsize(row));
    for (float x : frame)
      if (!std::isfinite(x))
        throw InputError(fmt::format("{}: holds a coordinate that is not finite", path.string()));
  }
  if (!file) throw InputError(fmt::format("{}: could not be read to its end", path.string()));
  return cache;
}

}  // namespace ecorche::inline v1
