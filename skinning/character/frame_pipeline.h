// The frames of a motion, several at once, and in their order where that matters.
#pragma once

#include <functional>

namespace ecorche {

// At most so many frames are under way: frame f has working memory number f % kFrameSlots to itself
// from its `begin` to its `end`.
inline constexpr int kFrameSlots = 4;

using FrameStep = std::function<void(int frame, int slot)>;

// begin(f, slot) in order, one at a time; make(f, slot) for several frames at once; end(f, slot) in
// order, one at a time. The result does not depend on the number of threads when make() depends on
// its frame alone. What a step throws ends the run.
void each_frame(int count, const FrameStep& begin, const FrameStep& make, const FrameStep& end);

}  // namespace ecorche
