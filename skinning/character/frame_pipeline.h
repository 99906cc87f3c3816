// Runs the frames of a motion in parallel, with steps in frame order before and after each.
#pragma once

#include <functional>

namespace ecorche::inline v1 {

// Frames in flight, at most: frame f owns workspace number f % kFrameSlots from its `begin` to its
// `end`.
inline constexpr int kFrameSlots = 4;

using FrameStep = std::function<void(int frame, int slot)>;

// begin(f, slot) in order, one at a time; make(f, slot) for several frames at once; end(f, slot) in
// order, one at a time. The result does not depend on the number of threads when make() depends on
// its frame alone. An exception of a step ends the run.
void for_each_frame(int count, const FrameStep& begin, const FrameStep& make, const FrameStep& end);

}  // namespace ecorche::inline v1
