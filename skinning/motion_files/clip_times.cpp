#include "skinning/motion_files/clip_times.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/text_scanner.h"
#include "anatomy/limits.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kUneven = 0.02;  // of a step: what clocks and rounding do

template <class T>
void keep_rows(int first, int last, int columns, std::vector<T>& values) {
  const auto row = [&](int f) { return values.begin() + std::ptrdiff_t(f) * columns; };
  values =
      std::vector<T>(std::make_move_iterator(row(first)), std::make_move_iterator(row(last + 1)));
}

}  // namespace

std::pair<int, int> frames_of_range(const ClipRange& range, const std::string& name, double fps,
                                    int count) {
  constexpr double kRoundingOfTimes = 1e-6;  // s
  const double lasts = (count - 1) / fps;
  const auto frame_at = [&](const ClipMoment& moment, const char* option) {
    if (moment.frame) {
      if (*moment.frame > count)
        throw UsageError(fmt::format("{}: {} {}f: the motion has frames 1 to {}", name, option,
                                     *moment.frame, count));
      return double(*moment.frame - 1);
    }
    if (moment.seconds > lasts + kRoundingOfTimes)
      throw UsageError(fmt::format("{}: {} {:g}s: the motion lasts from 0 to {:.3f} s", name,
                                   option, moment.seconds, lasts));
    return moment.seconds * fps;
  };
  const double slack = kRoundingOfTimes * fps;
  const int first = range.from ? int(std::ceil(frame_at(*range.from, "--from") - slack)) : 0;
  const int last = range.to ? int(std::floor(frame_at(*range.to, "--to") + slack)) : count - 1;
  if (first > last)
    throw UsageError(
        fmt::format("{}: no frame between --from and --to; of {} frames at {:.4g} a second they "
                    "name {} and {}",
                    name, count, fps, first + 1, last + 1));
  return {first, std::min(last, count - 1)};
}

double rate_of(const std::vector<double>& times) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < times.size(); ++k) steps.push_back(times[k] - times[k - 1]);
  std::nth_element(steps.begin(), steps.begin() + std::ptrdiff_t(steps.size() / 2), steps.end());
  const double fps = 1 / steps[steps.size() / 2], whole = std::round(fps);
  return std::abs(fps - whole) < 2e-3 * fps ? whole : fps;
}

void set_times(const std::vector<double>& times, MotionClip& clip) {
  if (times.size() < 2) return;
  clip.fps = rate_of(times);
  double worst = 0;
  for (std::size_t k = 0; k < times.size(); ++k)
    worst = std::max(worst, std::abs((times[k] - times[0]) * clip.fps - double(k)));
  if (worst < kUneven * double(times.size())) {
    double step = 0;
    for (std::size_t k = 1; k < times.size(); ++k)
      step = std::max(step, std::abs((times[k] - times[k - 1]) * clip.fps - 1));
    if (step < 5 * kUneven) return;
  }
  const double frames = std::floor((times.back() - times.front()) * clip.fps + 1e-6) + 1;
  if (frames > limits::kMotionFrames)
    throw LimitError(fmt::format("{}: {:.0f} frames at {:.4g} a second; the limit is {}", clip.name,
                                 frames, clip.fps, limits::kMotionFrames));
  const auto turns = std::move(clip.rotations);
  const auto shifts = std::move(clip.translations);
  clip.rotations.clear();
  clip.translations.clear();
  clip.frame_count = int(frames);
  std::size_t k = 0;
  for (int f = 0; f < clip.frame_count; ++f) {
    const double t = times[0] + f / clip.fps;
    while (k + 2 < times.size() && times[k + 1] <= t) ++k;
    const double u = std::clamp((t - times[k]) / (times[k + 1] - times[k]), 0.0, 1.0);
    for (int r = 0; r < clip.rotation_tracks; ++r) {
      const std::size_t at = k * std::size_t(clip.rotation_tracks) + std::size_t(r);
      clip.rotations.push_back(Quat(turns[at])
                                   .slerp(u, Quat(turns[at + std::size_t(clip.rotation_tracks)]))
                                   .toRotationMatrix());
    }
    for (int r = 0; r < clip.translation_tracks; ++r) {
      const std::size_t at = k * std::size_t(clip.translation_tracks) + std::size_t(r);
      clip.translations.push_back((1 - u) * shifts[at] +
                                  u * shifts[at + std::size_t(clip.translation_tracks)]);
    }
  }
  clip.warnings.push_back(
      fmt::format("{}: its {} frames are at uneven times; they are sampled at {:.4g} a second",
                  clip.name, times.size(), clip.fps));
}

ClipMoment read_moment(const std::string& text, const std::string& where) {
  const std::size_t unit = text.find_last_of("0123456789.") + 1;
  const std::string ending = text.substr(std::min(unit, text.size()));
  double value = 0;
  long long frame = 0;
  ClipMoment out;
  if (ending == "f" && parse_whole(text.substr(0, unit), frame) && frame >= 1 &&
      frame <= limits::kMotionFrames) {
    out.frame = int(frame);
    return out;
  }
  const bool known = ending.empty() || ending == "s" || ending == "ms";
  if (!known || !parse_number(text.substr(0, unit), value) || value < 0 || value > 1e6)
    throw UsageError(
        fmt::format("{}: '{}' is no moment of a motion; write seconds (1.5 or 1.5s, 150ms) or a "
                    "frame, counted from 1 (36f)",
                    where, printable(text)));
  out.seconds = ending == "ms" ? value / 1000 : value;
  return out;
}

void cut_clip(const ClipRange& range, MotionClip& clip) {
  if (!range.from && !range.to) return;
  const auto [first, last] = frames_of_range(range, clip.name, clip.fps, clip.frame_count);
  keep_rows(first, last, clip.rotation_tracks, clip.rotations);
  keep_rows(first, last, clip.translation_tracks, clip.translations);
  clip.frame_count = last - first + 1;
}

void cut_motion(const ClipRange& range, const std::string& name, Motion& motion) {
  if (!range.from && !range.to) return;
  const auto [first, last] = frames_of_range(range, name, motion.fps, int(motion.frames.size()));
  keep_rows(first, last, 1, motion.frames);
}

}  // namespace ecorche::inline v1
