// MDD vertex caches, all big endian: int32 samples, int32 points, float32 seconds of each sample;
// then samples x points x 3 float32.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "anatomy/files/atomic_file.h"

namespace ecorche::inline v1 {

// Streams a cache to a temporary file beside `path`; finish() renames it. Without finish() nothing
// appears.
class MddWriter {
 public:
  // The header comes first, so the number of frames must be known. Throws OutputError;
  // std::invalid_argument unless points, frames and fps are above zero.
  MddWriter(std::filesystem::path path, int point_count, int frame_count, double fps);

  // Precondition: positions holds point_count rows of `stride` floats, x y z first.
  void add_frame(std::span<const float> positions, int stride = 4);
  // std::invalid_argument unless as many frames were added as were promised.
  void finish();

 private:
  std::filesystem::path path_;
  AtomicFile file_;
  std::vector<std::uint32_t> row_;
  int points_ = 0, frames_ = 0, added_ = 0;
};

struct MddCache {
  int points = 0;
  std::vector<float> seconds;              // #samples
  std::vector<std::vector<float>> frames;  // #samples, each points x 3
};

// Throws InputError (malformed, not finite, truncated) or LimitError (more than `max_bytes` of
// samples).
MddCache read_mdd(const std::filesystem::path& path,
                  std::uint64_t max_bytes = std::uint64_t{4} << 30);

}  // namespace ecorche::inline v1
