// PC2 vertex caches: "POINTCACHE2\0", then little endian int32 version 1, int32 points, float32
// start frame, float32 frames a sample, int32 samples; then samples x points x 3 float32.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "anatomy/files/atomic_file.h"

namespace ecorche::inline v1 {

// Streams a cache to a temporary file beside `path`; finish() completes the header and renames it.
// Without finish() nothing appears.
class Pc2Writer {
 public:
  // start_frame and frame_step are what readers show, in frames. Throws OutputError.
  Pc2Writer(std::filesystem::path path, int point_count, float start_frame = 0,
            float frame_step = 1);

  // Precondition: positions holds point_count rows of `stride` floats, x y z first.
  void add_frame(std::span<const float> positions, int stride = 4);
  void finish();

 private:
  std::filesystem::path path_;
  AtomicFile file_;
  std::vector<float> row_;
  int points_ = 0;
  std::int32_t frames_ = 0;
};

struct Pc2Cache {
  int points = 0;
  float start_frame = 0, frame_step = 1;
  std::vector<std::vector<float>> frames;  // #samples, each points x 3
};

// Throws InputError (malformed, not finite, truncated) or LimitError (more than `max_bytes` of
// samples).
Pc2Cache read_pc2(const std::filesystem::path& path,
                  std::uint64_t max_bytes = std::uint64_t{4} << 30);

}  // namespace ecorche::inline v1
