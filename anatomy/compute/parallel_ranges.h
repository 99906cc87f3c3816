// Loops over ranges, on this thread or on all.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstddef>

#include "anatomy/compute/threads.h"

namespace ecorche::inline v1 {

// act(first, last) for ranges that together are 0 .. count; several threads take ranges of about
// `grain`.
template <class Act>
void parallel_for_ranges(std::size_t count, std::size_t grain, Threads threads, const Act& act) {
  if (threads == Threads::one) return act(std::size_t{0}, count);
  // Isolated: while it waits, this thread must not begin other work in the same memory.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                      [&](const auto& range) { act(range.begin(), range.end()); });
  });
}

}  // namespace ecorche::inline v1
