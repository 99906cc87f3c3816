// Times of a motion's frames: samples at uneven times, and parts of a motion.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/motion_files/motion_clip.h"

namespace ecorche::inline v1 {

// The rate of samples at these rising times, s: of their median step, whole where it nearly is one.
// Precondition: two times at least.
double rate_of(const std::vector<double>& times);

// Gives a clip whose frames were taken at `times` (#frames, rising, s) an even rate: rotations turn
// and translations go straight from frame to frame. Frames at even times stay as they are; else a
// warning says how uneven they were.
void set_times(const std::vector<double>& times, MotionClip& clip);

// Where a part of a motion begins or ends: a frame, counted from 1, or a moment, s.
struct ClipMoment {
  std::optional<int> frame;
  double seconds = 0;
};

// "1.5" and "1.5s" are seconds, "150ms" milliseconds, "36f" the 36th frame. Throws UsageError that
// begins with `where`.
ClipMoment read_moment(const std::string& text, const std::string& where);

// A part of a motion, its ends included.
struct ClipRange {
  std::optional<ClipMoment> from, to;
};

// First and last frame of a range of `count` frames, counted from 0. Throws UsageError, in the name
// of the file, where there are none.
std::pair<int, int> frames_of_range(const ClipRange& range, const std::string& name, double fps,
                                    int count);

// Keeps the range. Throws UsageError, in the name of the file, where the motion has none of it.
void cut_clip(const ClipRange& range, MotionClip& clip);
void cut_motion(const ClipRange& range, const std::string& name, Motion& motion);

}  // namespace ecorche::inline v1
