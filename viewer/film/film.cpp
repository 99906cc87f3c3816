#include "viewer/film/film.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"

namespace ecorche {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Hands slots around between two threads, and an end: finished, or an error on either side.
class Channel {
 public:
  void put(int slot) {
    const std::lock_guard lock(mutex_);
    slots_.push_back(slot);
    changed_.notify_all();
  }
  // Nothing once the channel is closed and empty.
  std::optional<int> take() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || !slots_.empty(); });
    if (slots_.empty()) return std::nullopt;
    const int slot = slots_.front();
    slots_.pop_front();
    return slot;
  }
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<int> slots_;
  bool closed_ = false;
};

// The number field of DIR/%04d.png.
struct Pattern {
  std::string before, after;
  int width = 0;

  std::filesystem::path name(int number) const {
    return fmt::format("{}{:0{}}{}", before, number, width, after);
  }
};

std::optional<Pattern> read_pattern(const std::filesystem::path& output) {
  const std::string text = output.string();
  const std::size_t percent = text.find('%');
  if (percent == std::string::npos) return std::nullopt;
  std::size_t end = percent + 1;
  int width = 0;
  while (end < text.size() && text[end] >= '0' && text[end] <= '9' && width < 100)
    width = 10 * width + (text[end++] - '0');
  const bool good = end < text.size() && text[end] == 'd' && width <= 9 &&
                    text.find('%', end) == std::string::npos && output.extension() == ".png";
  if (!good) throw UsageError(fmt::format("{}: pictures are named like DIR/%04d.png", text));
  return Pattern{text.substr(0, percent), text.substr(end + 1), width};
}

bool is_still(const std::filesystem::path& output) {
  return output.extension() == ".png" && !read_pattern(output);
}

class FrameWriter {
 public:
  FrameWriter(const FilmOptions& options, int width, int height)
      : pattern_(read_pattern(options.output)) {
    number_ = options.first_number;
    step_ = options.number_step;
    if (is_still(options.output)) {
      still_ = options.output;
      check_output(still_);
    } else if (!pattern_) {
      video_.emplace(options.output, width, height, options.video);
    } else {
      make_output_folder(options.output.parent_path());
    }
  }
  void add(const Image& image) {
    if (video_) {
      video_->add(image);
    } else {
      write_png(pattern_ ? pattern_->name(number_) : still_, image);
      number_ += step_;
    }
  }
  void finish() {
    if (video_) video_->finish();
  }

 private:
  std::optional<Pattern> pattern_;
  std::optional<VideoPipe> video_;
  std::filesystem::path still_;
  int number_ = 1, step_ = 1;
};

constexpr int slot_count = 2;

// Three stages with two buffers between neighbours. The first error stops all; it is rethrown by
// the caller's thread.
struct Pipeline {
  std::array<Scene, slot_count> scenes;
  std::array<Image, slot_count> images;
  Channel free_scenes, full_scenes, free_images, full_images;
  std::mutex mutex;
  std::exception_ptr error;

  Pipeline() {
    for (int i = 0; i < slot_count; ++i) free_scenes.put(i), free_images.put(i);
  }
  void stop(std::exception_ptr reason) {
    {
      const std::lock_guard lock(mutex);
      if (!error) error = std::move(reason);
    }
    for (Channel* channel : {&free_scenes, &full_scenes, &free_images, &full_images})
      channel->close();
  }
  bool stopped() {
    const std::lock_guard lock(mutex);
    return error != nullptr;
  }
};

void pose_frames(Pipeline& pipeline, int frames, const FrameSource& source, double& seconds) {
  try {
    for (int f = 0; f < frames; ++f) {
      const std::optional<int> slot = pipeline.free_scenes.take();
      if (!slot || pipeline.stopped()) return;
      const Clock::time_point start = Clock::now();
      source(f, pipeline.scenes[*slot]);
      seconds += since(start);
      pipeline.full_scenes.put(*slot);
    }
    pipeline.full_scenes.close();
  } catch (...) {
    pipeline.stop(std::current_exception());
  }
}

void write_frames(Pipeline& pipeline, FrameWriter& writer, const std::function<void(int)>& progress,
                  double& seconds) {
  try {
    int done = 0;
    while (const std::optional<int> slot = pipeline.full_images.take()) {
      if (pipeline.stopped()) return;
      const Clock::time_point start = Clock::now();
      writer.add(pipeline.images[*slot]);
      seconds += since(start);
      pipeline.free_images.put(*slot);
      if (progress) progress(++done);
    }
  } catch (...) {
    pipeline.stop(std::current_exception());
  }
}

// The columns of `second` from `begin` on, put into the picture from column `to` on.
void put_columns(const Image& second, int begin, int to, Image& picture) {
  const int count = std::min(second.width - begin, picture.width - to);
  for (int y = 0; y < picture.height && count > 0; ++y)
    std::copy_n(second.pixel(begin, y), 4 * std::size_t(count), picture.pixel(to, y));
}

struct PictureSize {
  int width, height;
};

// A frame's picture of its scene, or of the two that are full next. False: there are no more.
bool draw_frame(Pipeline& pipeline, Renderer& renderer, const FilmOptions& options,
                const PictureSize& size, int scene, Image& picture) {
  const auto draw = [&](int slot, int width) {
    Image out = renderer.render(pipeline.scenes[slot].list, width, size.height);
    pipeline.free_scenes.put(slot);
    return out;
  };
  if (options.pairing == Pairing::none) {
    picture = draw(scene, size.width);
    return true;
  }
  const bool beside = options.pairing == Pairing::beside;
  const int half = beside ? size.width / 2 : size.width;
  const Image first = draw(scene, half);
  const std::optional<int> other = pipeline.full_scenes.take();
  if (!other) return false;
  const Image second = draw(*other, size.width - (beside ? half : 0));
  const int line = beside ? half : int(std::clamp(options.wipe, 0.0f, 1.0f) * float(size.width));
  picture = make_image(size.width, size.height);
  picture.transparent = first.transparent;
  put_columns(first, 0, 0, picture);
  put_columns(second, beside ? 0 : line, line, picture);
  return true;
}

void draw_frames(Pipeline& pipeline, Renderer& renderer, const FilmOptions& options,
                 const PictureSize& size, double& seconds) {
  try {
    int frame = 0;
    while (const std::optional<int> scene = pipeline.full_scenes.take()) {
      const std::optional<int> image = pipeline.free_images.take();
      if (!image || pipeline.stopped()) return;
      const Clock::time_point start = Clock::now();
      if (!draw_frame(pipeline, renderer, options, size, *scene, pipeline.images[*image])) break;
      if (options.finish) options.finish(frame++, pipeline.images[*image]);
      seconds += since(start);
      pipeline.full_images.put(*image);
    }
    pipeline.full_images.close();
  } catch (...) {
    pipeline.stop(std::current_exception());
  }
}

int even(int size) { return size + size % 2; }

}  // namespace

FilmReport make_film(const FilmOptions& options, int frames, const FrameSource& source,
                     const std::function<void(int)>& progress) {
  if (frames < 1) throw UsageError("a film needs at least one frame");
  const bool still = is_still(options.output), pictures = still || read_pattern(options.output);
  if (!pictures && options.output.extension() != ".mp4")
    throw UsageError(fmt::format(
        "{}: films end in .mp4; pictures are named like DIR/%04d.png, one alone STILL.png",
        options.output.string()));
  if (still && frames > 1)
    throw UsageError(
        fmt::format("{}: {} frames in one picture; name numbered ones like DIR/%04d.png",
                    options.output.string(), frames));
  if (!pictures && options.render.transparent)
    throw UsageError(fmt::format("{}: films have no transparency; write pictures like DIR/%04d.png",
                                 options.output.string()));
  FilmReport report;
  report.frames = frames;
  if (options.width < 1 || options.height < 1)
    throw UsageError(
        fmt::format("film size {}x{}: must be at least 1x1", options.width, options.height));
  report.width = pictures ? options.width : even(options.width);
  report.height = pictures ? options.height : even(options.height);
  if (std::max(report.width, report.height) > 8192)
    throw LimitError(
        fmt::format("film size {}x{}: at most 8192 a side", options.width, options.height));

  const Clock::time_point start = Clock::now();
  Renderer renderer(options.render);
  report.driver = renderer.driver();
  FrameWriter writer(options, report.width, report.height);
  Pipeline pipeline;
  {
    const int scenes = options.pairing == Pairing::none ? frames : 2 * frames;
    const std::jthread poser([&] { pose_frames(pipeline, scenes, source, report.pose_seconds); });
    const std::jthread encoder(
        [&] { write_frames(pipeline, writer, progress, report.write_seconds); });
    draw_frames(pipeline, renderer, options, {report.width, report.height}, report.draw_seconds);
  }
  if (pipeline.error) std::rethrow_exception(pipeline.error);
  writer.finish();
  report.seconds = since(start);
  return report;
}

}  // namespace ecorche
