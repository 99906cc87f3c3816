// Frames -> ffmpeg, a program of its own, through a pipe.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "viewer/image.h"

namespace ecorche {

struct VideoOptions {
  double fps = 30;
  int quality = 18;                // H.264 constant rate factor, 0 lossless .. 51
  std::string program = "ffmpeg";  // looked for in PATH
  // s without a byte read or written, after which the program counts as hung and is ended
  double patience = 60;
};

// H.264, yuv420p, faststart. Appears under its name only when finish() succeeds: the program ended
// well, and the film has all frames.
class VideoPipe {
 public:
  // Throws UsageError for a frame rate that is not above 0, OutputError when the folder is missing
  // or the program cannot be started (it then names the package).
  VideoPipe(std::filesystem::path file, int width, int height, const VideoOptions& options = {});
  ~VideoPipe();
  VideoPipe(const VideoPipe&) = delete;
  VideoPipe& operator=(const VideoPipe&) = delete;

  // Precondition: the size given above, even. Throws OutputError with what the program said when it
  // has died or hangs, or left a film that is not whole.
  void add(const Image& frame);
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ecorche
