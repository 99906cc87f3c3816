// Range of a motion that a film shows.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "anatomy/skeleton.h"

namespace ecorche {

// Seconds of the motion.
struct Span {
  double begin = 0, end = 0;
};

// Frames of a motion, counted from 1, each `step`th.
struct FrameRange {
  int first = 1;
  std::optional<int> last;  // to the end when left out
  int step = 1;
};

// "12", "12-80", "12-" (to the end), each with "x2" behind it for every second frame. Throws
// UsageError that begins with `where`.
FrameRange read_frame_range(const std::string& text, const std::string& where);

// s, of the frames of a range, or of the range's last that the motion has. Throws UsageError where
// the motion has none of it.
std::vector<double> moments_of(const FrameRange& range, const Motion& motion);

// Begin and end of a film of the motion. Throws UsageError for a span that is reversed or outside
// the motion.
Span span_within(const std::optional<double>& from, const std::optional<double>& to,
                 const Motion& motion);

}  // namespace ecorche
