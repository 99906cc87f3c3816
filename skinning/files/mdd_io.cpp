#include "skinning/files/mdd_io.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

static_assert(std::endian::native == std::endian::little, "MDD's bytes are turned round");

std::uint32_t big_endian(std::uint32_t v) { return __builtin_bswap32(v); }

void write_words(std::ofstream& out, const std::vector<std::uint32_t>& words) {
  out.write(reinterpret_cast<const char*>(words.data()), std::streamsize(4 * words.size()));
}

void read_words(std::ifstream& in, std::vector<std::uint32_t>& words) {
  in.read(reinterpret_cast<char*>(words.data()), std::streamsize(4 * words.size()));
  for (std::uint32_t& word : words) word = big_endian(word);
}

}  // namespace

MddWriter::MddWriter(std::filesystem::path path, int point_count, int frame_count, double fps)
    : path_(std::move(path)), file_(path_), points_(point_count), frames_(frame_count) {
  if (point_count <= 0 || frame_count <= 0 || !(fps > 0))
    throw std::invalid_argument("MddWriter: a cache needs points, frames and a rate");
  std::vector<std::uint32_t> header{big_endian(std::uint32_t(frame_count)),
                                    big_endian(std::uint32_t(point_count))};
  for (int f = 0; f < frame_count; ++f)
    header.push_back(big_endian(std::bit_cast<std::uint32_t>(float(f / fps))));
  write_words(file_.stream(), header);
  row_.resize(3 * std::size_t(points_));
}

void MddWriter::add_frame(std::span<const float> positions, int stride) {
  if (stride < 3 || positions.size() < std::size_t(points_) * std::size_t(stride))
    throw std::invalid_argument(
        fmt::format("MddWriter: {} floats do not hold {} points", positions.size(), points_));
  for (std::size_t i = 0; i < std::size_t(points_); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      row_[3 * i + k] = big_endian(std::bit_cast<std::uint32_t>(positions[i * stride + k]));
  write_words(file_.stream(), row_);
  if (!file_.stream()) file_.fail();
  ++added_;
}

void MddWriter::finish() {
  if (added_ != frames_)
    throw std::invalid_argument(
        fmt::format("MddWriter: {} frames were promised, {} came", frames_, added_));
  file_.commit();
}

MddCache read_mdd(const std::filesystem::path& path, std::uint64_t max_bytes) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("{}: cannot be opened", path.string()));
  std::vector<std::uint32_t> words(2);
  read_words(file, words);
  const std::uint64_t frames = words[0], points = words[1];
  if (!file || frames == 0 || points == 0 || frames > 0x7fffffff || points > 0x7fffffff)
    throw InputError(fmt::format("{}: {} samples of {} points make no MDD cache", path.string(),
                                 frames, points));
  // A row fits 64 bits; the whole may not, so the file's size is asked a row at a time.
  const std::uint64_t size = std::filesystem::file_size(path), row = 12 * points,
                      header = 8 + 4 * frames;
  if (size < header || (size - header) / row < frames)
    throw InputError(
        fmt::format("{}: ends before its {} samples of {} points", path.string(), frames, points));
  if (row * frames > max_bytes)
    throw LimitError(fmt::format("{}: {} bytes of samples, the limit is {}", path.string(),
                                 row * frames, max_bytes));
  const auto take = [&](std::size_t count) {
    words.resize(count);
    read_words(file, words);
    if (!file) throw InputError(fmt::format("{}: could not be read to its end", path.string()));
    std::vector<float> out(count);
    for (std::size_t i = 0; i < count; ++i) {
      out[i] = std::bit_cast<float>(words[i]);
      if (!std::isfinite(out[i]))
        throw InputError(fmt::format("{}: holds a number that is not finite", path.string()));
    }
    return out;
  };
  MddCache cache{int(points), take(frames), {}};
  for (std::uint64_t f = 0; f < frames; ++f) cache.frames.push_back(take(3 * points));
  return cache;
}

}  // namespace ecorche::inline v1
