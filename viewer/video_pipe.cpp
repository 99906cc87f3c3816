#include "viewer/video_pipe.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "anatomy/atomic_file.h"
#include "anatomy/child_processes.h"
#include "anatomy/errors.h"

namespace ecorche {
namespace {

constexpr std::size_t kept_message = 2000;

// Removes the signal that a closed pipe sends, for this thread and while it writes: the error code says it as well.
class NoPipeSignal {
 public:
  NoPipeSignal() {
    sigset_t pipe;
    sigemptyset(&pipe);
    sigaddset(&pipe, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipe, &before_);
  }
  ~NoPipeSignal() {
    sigset_t pipe;
    sigemptyset(&pipe);
    sigaddset(&pipe, SIGPIPE);
    const timespec at_once{0, 0};
    while (!sigismember(&before_, SIGPIPE) && sigtimedwait(&pipe, nullptr, &at_once) > 0) continue;
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }

 private:
  sigset_t before_;
};

}  // namespace

struct VideoPipe::Impl {
  Impl(std::filesystem::path name, int w, int h, const VideoOptions& options) : file(std::move(name)), width(w), height(h) {
    file.release_stream();
    start(options);
  }
  ~Impl() {
    if (input >= 0) close(input);
    if (child.pid() > 0) {
      kill(child.pid(), SIGKILL);
      waitpid(child.pid(), nullptr, 0);
    }
    if (messages) std::fclose(messages);
  }

  void start(const VideoOptions& options);
  std::string said() const;
  int wait();

  AtomicFile file;
  int width, height;
  std::string program;
  ChildProcess child;
  int input = -1;
  std::FILE* messages = nullptr;  // what the program writes on its standard error
  std::vector<std::uint8_t> rgb;
};

void VideoPipe::Impl::start(const VideoOptions& options) {
  program = options.program;
  const std::vector<std::string> words = {
      program,       "-hide_banner", "-nostdin", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s",
      fmt::format("{}x{}", width, height), "-framerate", fmt::format("{}", options.fps), "-i", "pipe:0", "-an",
      // Colours as HD video has them, said in the file; a fixed number of threads, as the bytes depend on it.
      "-vf", "scale=out_color_matrix=bt709:out_range=tv", "-c:v", "libx264", "-preset", "veryfast", "-crf", fmt::format("{}", options.quality),
      "-pix_fmt", "yuv420p", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "iec61966-2-1", "-color_range", "tv",
      "-threads", "2", "-fflags", "+bitexact", "-flags:v", "+bitexact", "-map_metadata", "-1", "-movflags", "+faststart", "-f", "mp4",
      file.temporary().string()};
  int ends[2];
  messages = std::tmpfile();
  if (!messages || pipe2(ends, O_CLOEXEC) != 0) throw OutputError(fmt::format("{}: cannot make a pipe: {}", program, std::strerror(errno)));
  input = ends[1];
  try {
    child = start_program(words, ends[0], fileno(messages), fileno(messages));
    close(ends[0]);
  } catch (const std::system_error& e) {
    close(ends[0]);
    throw OutputError(fmt::format("cannot start '{}': {}; install the package ffmpeg, or write pictures instead: -o DIR/%04d.png", program, e.code().message()));
  }
}

std::string VideoPipe::Impl::said() const {
  std::string text(kept_message, '\0');
  std::rewind(messages);
  text.resize(std::fread(text.data(), 1, text.size(), messages));
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.empty() ? "it said nothing" : text;
}

// The exit code; -1 if a signal ended it.
int VideoPipe::Impl::wait() {
  if (input >= 0) close(input);
  input = -1;
  int status = 0;
  while (waitpid(child.pid(), &status, 0) < 0 && errno == EINTR) continue;
  child.ended();
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

VideoPipe::VideoPipe(std::filesystem::path file, int width, int height, const VideoOptions& options) {
  if (!(options.fps > 0) || !(options.fps <= 1000)) throw UsageError(fmt::format("frame rate {}: must be above 0 and at most 1000", options.fps));
  if (width < 2 || height < 2 || width % 2 || height % 2) throw std::invalid_argument(fmt::format("VideoPipe: size {}x{} is not even", width, height));
  impl_ = std::make_unique<Impl>(std::move(file), width, height, options);
}

VideoPipe::~VideoPipe() = default;

void VideoPipe::add(const Image& frame) {
  Impl& p = *impl_;
  if (frame.width != p.width || frame.height != p.height)
    throw std::invalid_argument(fmt::format("VideoPipe: a frame of {}x{} in a film of {}x{}", frame.width, frame.height, p.width, p.height));
  const std::size_t pixels = static_cast<std::size_t>(p.width) * p.height;
  p.rgb.resize(3 * pixels);
  for (std::size_t i = 0; i < pixels; ++i) std::memcpy(&p.rgb[3 * i], &frame.rgba[4 * i], 3);
  const NoPipeSignal quiet;
  for (std::size_t sent = 0; sent < p.rgb.size();) {
    const ssize_t n = write(p.input, p.rgb.data() + sent, p.rgb.size() - sent);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const int code = p.wait();
      throw OutputError(fmt::format("{} ended early with exit code {}: {}", p.program, code, p.said()));
    }
    sent += static_cast<std::size_t>(n);
  }
}

void VideoPipe::finish() {
  const int code = impl_->wait();
  if (code != 0) throw OutputError(fmt::format("{} failed with exit code {}: {}", impl_->program, code, impl_->said()));
  impl_->file.commit();
}

}  // namespace ecorche
