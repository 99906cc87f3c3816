#include "skinning/pc2_io.h"

#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

#include "anatomy/errors.h"

namespace ecorche {
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

Pc2Writer::Pc2Writer(std::filesystem::path path, int point_count, float start_frame, float frame_step)
    : path_(std::move(path)), points_(point_count) {
  if (point_count <= 0) throw std::invalid_argument("Pc2Writer: a cache needs at least one point");
  temporary_ = path_;
  temporary_ += fmt::format(".{}.part", ::getpid());
  file_.open(temporary_, std::ios::binary | std::ios::trunc);
  Header header;
  header.points = point_count;
  header.start_frame = start_frame;
  header.frame_step = frame_step;
  file_.write(reinterpret_cast<const char*>(&header), sizeof header);
  if (!file_) throw OutputError(fmt::format("{}: cannot be written; check that the folder exists and has room", path_.string()));
  row_.resize(3 * static_cast<std::size_t>(points_));
}

Pc2Writer::~Pc2Writer() {
  if (finished_) return;
  file_.close();
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void Pc2Writer::add_frame(std::span<const float> positions, int stride) {
  if (stride < 3 || positions.size() < static_cast<std::size_t>(points_) * static_cast<std::size_t>(stride))
    throw std::invalid_argument(fmt::format("Pc2Writer: {} floats do not hold {} points", positions.size(), points_));
  for (int i = 0; i < points_; ++i) std::memcpy(&row_[3 * std::size_t(i)], &positions[std::size_t(i) * std::size_t(stride)], 12);
  file_.write(reinterpret_cast<const char*>(row_.data()), static_cast<std::streamsize>(row_.size() * sizeof(float)));
  if (!file_) throw OutputError(fmt::format("{}: writing frame {} failed; is the disk full?", path_.string(), frames_));
  ++frames_;
}

void Pc2Writer::finish() {
  file_.seekp(offsetof(Header, frames));
  file_.write(reinterpret_cast<const char*>(&frames_), sizeof frames_);
  file_.close();
  std::error_code error;
  if (file_) std::filesystem::rename(temporary_, path_, error);
  if (!file_ || error) throw OutputError(fmt::format("{}: could not be completed; is the disk full?", path_.string()));
  finished_ = true;
}

Pc2Cache read_pc2(const std::filesystem::path& path, std::uint64_t max_bytes) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("{}: cannot be opened", path.string()));
  Header header;
  const Header expected;
  file.read(reinterpret_cast<char*>(&header), sizeof header);
  if (!file || std::memcmp(header.magic, expected.magic, sizeof header.magic) != 0 || header.version != 1)
    throw InputError(fmt::format("{}: not a PC2 point cache of version 1", path.string()));
  if (header.points <= 0 || header.frames < 0)
    throw InputError(fmt::format("{}: {} points in {} samples make no cache", path.string(), header.points, header.frames));
  const std::uint64_t row = 12 * static_cast<std::uint64_t>(header.points);
  const std::uint64_t bytes = row * static_cast<std::uint64_t>(header.frames);
  if (std::filesystem::file_size(path) < sizeof header + bytes)
    throw InputError(fmt::format("{}: ends before its {} samples of {} points", path.string(), header.frames, header.points));
  if (bytes > max_bytes) throw LimitError(fmt::format("{}: {} bytes of samples, the limit is {}", path.string(), bytes, max_bytes));
  Pc2Cache cache{header.points, header.start_frame, header.frame_step, {}};
  cache.frames.resize(static_cast<std::size_t>(header.frames));
  for (std::vector<float>& frame : cache.frames) {
    frame.resize(3 * static_cast<std::size_t>(header.points));
    file.read(reinterpret_cast<char*>(frame.data()), static_cast<std::streamsize>(row));
    for (float x : frame)
      if (!std::isfinite(x)) throw InputError(fmt::format("{}: holds a coordinate that is not finite", path.string()));
  }
  if (!file) throw InputError(fmt::format("{}: could not be read to its end", path.string()));
  return cache;
}

}  // namespace ecorche
