#include "viewer/film.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "anatomy/errors.h"

namespace ecorche {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

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

  std::filesystem::path name(int number) const { return fmt::format("{}{:0{}}{}", before, number, width, after); }
};

std::optional<Pattern> read_pattern(const std::filesystem::path& output) {
  const std::string text = output.string();
  const std::size_t percent = text.find('%');
  if (percent == std::string::npos) return std::nullopt;
  std::size_t end = percent + 1;
  int width = 0;
  while (end < text.size() && text[end] >= '0' && text[end] <= '9' && width < 100) width = 10 * width + (text[end++] - '0');
  const bool good = end < text.size() && text[end] == 'd' && width <= 9 && text.find('%', end) == std::string::npos && output.extension() == ".png";
  if (!good) throw UsageError(fmt::format("{}: pictures are named like DIR/%04d.png", text));
  return Pattern{text.substr(0, percent), text.substr(end + 1), width};
}

class FrameWriter {
 public:
  FrameWriter(const FilmOptions& options, int width, int height) : pattern_(read_pattern(options.output)) {
    if (!pattern_) video_.emplace(options.output, width, height, options.video);
  }
  void add(const Image& image) {
    ++count_;
    if (video_) {
      video_->add(image);
    } else {
      write_png(pattern_->name(count_), image);
    }
  }
  void finish() {
    if (video_) video_->finish();
  }

 private:
  std::optional<Pattern> pattern_;
  std::optional<VideoPipe> video_;
  int count_ = 0;
};

constexpr int slot_count = 2;

// Three stages with two buffers between neighbours. The first error stops all; it is rethrown by the caller's thread.
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
    for (Channel* channel : {&free_scenes, &full_scenes, &free_images, &full_images}) channel->close();
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

void write_frames(Pipeline& pipeline, FrameWriter& writer, const std::function<void(int)>& progress, double& seconds) {
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

void draw_frames(Pipeline& pipeline, Renderer& renderer, int width, int height, double& seconds) {
  try {
    while (const std::optional<int> scene = pipeline.full_scenes.take()) {
      const std::optional<int> image = pipeline.free_images.take();
      if (!image || pipeline.stopped()) return;
      const Clock::time_point start = Clock::now();
      pipeline.images[*image] = renderer.render(pipeline.scenes[*scene].list, width, height);
      seconds += since(start);
      pipeline.free_scenes.put(*scene);
      pipeline.full_images.put(*image);
    }
    pipeline.full_images.close();
  } catch (...) {
    pipeline.stop(std::current_exception());
  }
}

int even(int size) { return size + size % 2; }

float ease(double t) {
  const double x = std::clamp(t, 0.0, 1.0);
  return static_cast<float>(x * x * (3 - 2 * x));
}

// Gaussian filter along the path; beyond its ends the first and last motion goes on, so that the camera does not lag there.
std::vector<Vec3> smooth(std::span<const Vec3> path, double sigma_frames) {
  const int n = static_cast<int>(path.size());
  const int reach = static_cast<int>(std::ceil(3 * sigma_frames));
  auto at = [&](int f) -> Vec3 {
    if (f < 0) return 2 * path[0] - path[std::min(-f, n - 1)];
    if (f >= n) return 2 * path[n - 1] - path[std::max(2 * (n - 1) - f, 0)];
    return path[f];
  };
  std::vector<Vec3> out(path.size());
  for (int f = 0; f < n; ++f) {
    Vec3 sum = Vec3::Zero();
    double weight = 0;
    for (int k = -reach; k <= reach; ++k) {
      const double w = sigma_frames > 0 ? std::exp(-0.5 * k * k / (sigma_frames * sigma_frames)) : 1;
      sum += w * at(f + k);
      weight += w;
    }
    out[f] = sum / weight;
  }
  return out;
}

}  // namespace

FilmReport make_film(const FilmOptions& options, int frames, const FrameSource& source, const std::function<void(int)>& progress) {
  if (frames < 1) throw UsageError("a film needs at least one frame");
  const bool pictures = read_pattern(options.output).has_value();
  if (!pictures && options.output.extension() != ".mp4")
    throw UsageError(fmt::format("{}: films end in .mp4; pictures are named like DIR/%04d.png", options.output.string()));
  FilmReport report;
  report.frames = frames;
  if (options.width < 1 || options.height < 1) throw UsageError(fmt::format("film size {}x{}: must be at least 1x1", options.width, options.height));
  report.width = pictures ? options.width : even(options.width);
  report.height = pictures ? options.height : even(options.height);
  if (std::max(report.width, report.height) > 8192)
    throw LimitError(fmt::format("film size {}x{}: at most 8192 a side", options.width, options.height));

  const Clock::time_point start = Clock::now();
  Renderer renderer(options.render);
  report.driver = renderer.driver();
  FrameWriter writer(options, report.width, report.height);
  Pipeline pipeline;
  {
    const std::jthread poser([&] { pose_frames(pipeline, frames, source, report.pose_seconds); });
    const std::jthread encoder([&] { write_frames(pipeline, writer, progress, report.write_seconds); });
    draw_frames(pipeline, renderer, report.width, report.height, report.draw_seconds);
  }
  if (pipeline.error) std::rethrow_exception(pipeline.error);
  writer.finish();
  report.seconds = since(start);
  return report;
}

std::vector<Camera> follow(std::span<const Vec3> roots, double fps, const FollowCamera& options) {
  std::vector<Camera> cameras(roots.size());
  if (roots.empty()) return cameras;
  const std::vector<Vec3> path = smooth(roots, options.smoothing * fps);
  const double first_height = roots.front().y();
  const int last = static_cast<int>(roots.size()) - 1;
  for (int f = 0; f <= last; ++f) {
    // The lead grows with speed, and is gone when the athlete stands.
    Vec3 speed = (path[std::min(f + 1, last)] - path[std::max(f - 1, 0)]) * fps / std::max(1, std::min(f + 1, last) - std::max(f - 1, 0));
    speed.y() = 0;
    const Vec3 ahead = options.lead * speed / std::max(1.0, speed.norm());
    const double share = last > 0 ? double(f) / last : 0;
    const float turn = ease((share - options.turn_begin) / std::max(1e-9, options.turn_end - options.turn_begin));
    const float azimuth = options.begin_azimuth + turn * (options.end_azimuth - options.begin_azimuth);
    Camera& camera = cameras[f];
    const Vec3f base = Vec3(path[f] + ahead).cast<float>();
    const float rise = options.climb * static_cast<float>(path[f].y() - first_height);
    camera.target = Vec3f(base.x(), options.target_height + rise, base.z());
    camera.eye = Vec3f(base.x() + options.distance * std::sin(azimuth), options.height + 0.5f * rise, base.z() + options.distance * std::cos(azimuth));
    camera.fov_y = options.fov_y;
    camera.near_plane = 0.3f;
    camera.far_plane = 200;
  }
  return cameras;
}

}  // namespace ecorche
