#include "skinning/character/frame_pipeline.h"

#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>

namespace ecorche::inline v1 {

void for_each_frame(int count, const FrameStep& begin, const FrameStep& make,
                    const FrameStep& end) {
  namespace tbb = oneapi::tbb;
  int next = 0;
  const auto first = [&](tbb::flow_control& flow) {
    if (next >= count) {
      flow.stop();
      return 0;
    }
    begin(next, next % kFrameSlots);
    return next++;
  };
  // A thread that waits within a frame must not begin another one: both may use the thread's own
  // memory.
  const auto middle = [&](int f) {
    tbb::this_task_arena::isolate([&] { make(f, f % kFrameSlots); });
    return f;
  };
  const auto last = [&](int f) { end(f, f % kFrameSlots); };
  tbb::parallel_pipeline(kFrameSlots,
                         tbb::make_filter<void, int>(tbb::filter_mode::serial_in_order, first) &
                             tbb::make_filter<int, int>(tbb::filter_mode::parallel, middle) &
                             tbb::make_filter<int, void>(tbb::filter_mode::serial_in_order, last));
}

}  // namespace ecorche::inline v1
