#include "viewer/film/video_pipe.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <span>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <tuple>
#include <vector>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/files/child_processes.h"
#include "viewer/film/film_check.h"

namespace ecorche {
namespace {

constexpr std::size_t kept_message = 2000;

// Removes the signal that a closed pipe sends, for this thread and while it writes: the error code
// says it as well.
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
  Impl(std::filesystem::path name, int w, int h, const VideoOptions& options)
      : file(std::move(name)), width(w), height(h) {
    file.release_stream();
    start(options);
  }
  ~Impl() {
    close_input();
    end();
  }

  void start(const VideoOptions& options);
  void send(std::span<const std::uint8_t> bytes);
  void close_input();
  void end();
  std::string said() const;
  int wait();

  AtomicFile file;
  int width, height;
  std::string program;
  double patience = 0;
  int frames = 0;
  ChildProcess child;
  int input = -1;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> messages{nullptr,
                                                           std::fclose};  // what the program says
  std::vector<std::uint8_t> rgb;
};

void VideoPipe::Impl::start(const VideoOptions& options) {
  program = options.program;
  patience = options.patience;
  const std::vector<std::string> words = {
      program, "-hide_banner", "-nostdin", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt",
      "rgb24", "-s", fmt::format("{}x{}", width, height), "-framerate",
      fmt::format("{}", options.fps), "-i", "pipe:0", "-an",
      // Colours as HD video has them, said in the file; a fixed number of threads, as the bytes
      // depend on it.
      "-vf", "scale=out_color_matrix=bt709:out_range=tv", "-c:v", "libx264", "-preset", "veryfast",
      "-crf", fmt::format("{}", options.quality), "-pix_fmt", "yuv420p", "-colorspace", "bt709",
      "-color_primaries", "bt709", "-color_trc", "iec61966-2-1", "-color_range", "tv", "-threads",
      "2", "-fflags", "+bitexact", "-flags:v", "+bitexact", "-map_metadata", "-1", "-movflags",
      "+faststart", "-f", "mp4", file.temporary().string()};
  int ends[2];
  messages.reset(std::tmpfile());
  if (!messages || pipe2(ends, O_CLOEXEC) != 0)
    throw OutputError(fmt::format("{}: cannot make a pipe: {}", program, std::strerror(errno)));
  input = ends[1];
  fcntl(input, F_SETFL, O_NONBLOCK);  // so that a program that stops reading is noticed
  try {
    child = start_program(words, ends[0], fileno(messages.get()), fileno(messages.get()));
    close(ends[0]);
  } catch (const std::system_error& e) {
    close(ends[0]);
    throw OutputError(
        fmt::format("cannot start '{}': {}; install the package ffmpeg, or write pictures instead: "
                    "-o DIR/%04d.png",
                    program, e.code().message()));
  }
}

std::string VideoPipe::Impl::said() const {
  std::string text(kept_message, '\0');
  std::rewind(messages.get());
  text.resize(std::fread(text.data(), 1, text.size(), messages.get()));
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.empty() ? "it said nothing" : text;
}

void VideoPipe::Impl::close_input() {
  if (input >= 0) close(input);
  input = -1;
}

void VideoPipe::Impl::end() {
  if (child.pid() <= 0) return;
  kill(-child.pid(), SIGKILL);
  while (waitpid(child.pid(), nullptr, 0) < 0 && errno == EINTR) continue;
  child.ended();
}

// The exit code; -1 if a signal ended it. A last pass over a long film takes its time: what counts
// is that the file goes on changing.
int VideoPipe::Impl::wait() {
  using Clock = std::chrono::steady_clock;
  using State = std::tuple<off_t, time_t, long>;
  constexpr std::chrono::milliseconds nap(5);
  close_input();
  State seen{};
  Clock::time_point changed = Clock::now();
  int status = 0;
  while (true) {
    const pid_t ended = waitpid(child.pid(), &status, WNOHANG);
    if (ended == child.pid() || (ended < 0 && errno != EINTR)) break;
    struct stat now {};
    if (stat(file.temporary().c_str(), &now) == 0 &&
        State(now.st_size, now.st_mtim.tv_sec, now.st_mtim.tv_nsec) != seen) {
      seen = {now.st_size, now.st_mtim.tv_sec, now.st_mtim.tv_nsec};
      changed = Clock::now();
    }
    if (std::chrono::duration<double>(Clock::now() - changed).count() > patience) {
      end();
      throw OutputError(fmt::format("{} hangs: it has not ended and written nothing for {:g} s: {}",
                                    program, patience, said()));
    }
    std::this_thread::sleep_for(nap);
  }
  child.ended();
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void VideoPipe::Impl::send(std::span<const std::uint8_t> bytes) {
  const NoPipeSignal quiet;
  while (!bytes.empty()) {
    const ssize_t n = write(input, bytes.data(), bytes.size());
    if (n >= 0) {
      bytes = bytes.subspan(std::size_t(n));
    } else if (errno == EAGAIN) {
      pollfd room{input, POLLOUT, 0};
      const int ready = poll(&room, 1, int(1e3 * patience));
      if (ready == 0) {
        end();
        throw OutputError(
            fmt::format("{} hangs: it has read nothing for {:g} s: {}", program, patience, said()));
      }
    } else if (errno != EINTR) {
      const int code = wait();
      throw OutputError(fmt::format("{} ended early with exit code {}: {}", program, code, said()));
    }
  }
}

VideoPipe::VideoPipe(std::filesystem::path file, int width, int height,
                     const VideoOptions& options) {
  if (!(options.fps > 0) || !(options.fps <= 1000))
    throw UsageError(fmt::format("frame rate {}: must be above 0 and at most 1000", options.fps));
  if (width < 2 || height < 2 || width % 2 || height % 2)
    throw std::invalid_argument(fmt::format("VideoPipe: size {}x{} is not even", width, height));
  impl_ = std::make_unique<Impl>(std::move(file), width, height, options);
}

VideoPipe::~VideoPipe() = default;

void VideoPipe::add(const Image& frame) {
  Impl& p = *impl_;
  if (frame.width != p.width || frame.height != p.height)
    throw std::invalid_argument(fmt::format("VideoPipe: a frame of {}x{} in a film of {}x{}",
                                            frame.width, frame.height, p.width, p.height));
  const std::size_t pixels = std::size_t(p.width) * p.height;
  p.rgb.resize(3 * pixels);
  for (std::size_t i = 0; i < pixels; ++i) std::memcpy(&p.rgb[3 * i], &frame.rgba[4 * i], 3);
  p.send(p.rgb);
  ++p.frames;
}

void VideoPipe::finish() {
  Impl& p = *impl_;
  const int code = p.wait();
  if (code != 0)
    throw OutputError(fmt::format("{} failed with exit code {}: {}", p.program, code, p.said()));
  if (const std::string fault = film_fault(p.file.temporary(), p.frames); !fault.empty())
    throw OutputError(fmt::format("{} ended well, but the film is not whole: {}; {}", p.program,
                                  fault, p.said()));
  p.file.commit();
}

}  // namespace ecorche
