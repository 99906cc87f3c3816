// A motion that goes on for ever: its end leads into its beginning.
#pragma once

#include <string>

#include "skinning/filters/filtered_motion.h"

namespace ecorche::inline v1 {

struct LoopOptions {
  bool keep_travel = true;  // else the figure stays in its place
  bool find = true;         // the longest part whose ends are alike, else all of it
  double over = 0.25;       // s over which the end goes over into the beginning
};

// Makes rounds of the motion (LoopRounds). Over the first `over` seconds of a round the motion
// comes from what followed its end, moved to where the round begins, to the round's own beginning:
// so the last frame is followed by the one that followed it in the recording. Throws UnfitError for
// a motion that is shorter than four times `over`. `name`: of the motion's file.
void make_loop(const std::string& name, const Skeleton& skeleton, const LoopOptions& options,
               FilteredMotion& filtered);

// Keeps the middle round, at the place of the first, once feet are planted. The frame after the
// last is the first one, moved by LoopRounds::round, or as it is where the way is taken out.
void close_loop(FilteredMotion& filtered);

}  // namespace ecorche::inline v1
