#include "skinning/filters/warp_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "anatomy/errors.h"
#include "anatomy/limits.h"
#include "skinning/motion/sample_motion.h"

namespace ecorche::inline v1 {
namespace {

// New frame f is frame f * step as it was.
void resample(double step, double frames, FilteredMotion& filtered) {
  if (!(frames <= limits::kMotionFrames))
    throw LimitError(fmt::format("--filter: the motion would have {:.0f} frames; the limit is {}",
                                 frames, limits::kMotionFrames));
  const int count = int(frames);
  const Motion given = std::move(filtered.motion);
  filtered.motion = {given.fps, std::vector<Pose>(std::size_t(count))};
  for (int f = 0; f < count; ++f)
    pose_at_frame(given, f * step, filtered.motion.frames[std::size_t(f)]);
  constexpr double kRounding = 1e-9;
  for (Contact& one : filtered.contacts) {
    one.begin = int(std::ceil(one.begin / step - kRounding));
    one.end = std::min(count, int(std::floor((one.end - 1) / step + kRounding)) + 1);
  }
  std::erase_if(filtered.contacts, [](const Contact& one) { return one.begin >= one.end; });
}

// Time that goes through what is there in `steps` steps of a frame, or a loop's round in as many.
void spread(double steps, FilteredMotion& filtered) {
  const double last = double(filtered.motion.frames.size()) - 1;
  const double whole = std::max(2.0, std::round(steps));
  double step = last / whole;
  if (filtered.loop) {
    step = filtered.loop->frames / whole;
    filtered.loop->frames = int(whole);
  }
  resample(step, filtered.loop ? 3 * whole : whole + 1, filtered);
  filtered.gravity *= step * step;
  filtered.belt *= step;
}

double steps_of(const FilteredMotion& filtered) {
  return filtered.loop ? filtered.loop->frames : double(filtered.motion.frames.size()) - 1;
}

}  // namespace

void warp_time(double speed, FilteredMotion& filtered) {
  if (filtered.motion.frames.size() < 2) return;
  spread(steps_of(filtered) / speed, filtered);
}

void fit_length(double length, FilteredMotion& filtered) {
  if (filtered.motion.frames.size() < 2) return;
  spread(length * filtered.motion.fps, filtered);
}

void change_rate(double fps, FilteredMotion& filtered) {
  constexpr double kRounding = 1e-9;
  double step = filtered.motion.fps / fps;
  double frames = std::floor((double(filtered.motion.frames.size()) - 1) / step + kRounding) + 1;
  if (filtered.loop) {
    const int round = std::max(2, int(std::round(filtered.loop->frames / step)));
    step = double(filtered.loop->frames) / round;
    filtered.loop->frames = round;
    frames = 3.0 * round;
  }
  resample(step, frames, filtered);
  filtered.motion.fps = fps;
}

}  // namespace ecorche::inline v1
