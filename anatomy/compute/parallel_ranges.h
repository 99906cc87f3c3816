// Work in runs, on this thread or on all.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstddef>

namespace ecorche {

enum class Threads { one, all };

// act(first, last) for runs that together are 0 .. count; several threads take runs of about `run`.
template <class Act>
void each_run(std::size_t count, std::size_t run, Threads threads, const Act& act) {
  if (threads == Threads::one) return act(std::size_t{0}, count);
  // Isolated: while it waits, this thread must not begin other work in the same memory.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, run),
                      [&](const auto& some) { act(some.begin(), some.end()); });
  });
}

}  // namespace ecorche
