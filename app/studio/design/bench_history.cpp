#include "app/studio/design/bench_history.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>

#include "app/edit/session.h"

namespace ecorche {
namespace {

double heap_megabytes() {
  const struct mallinfo2 heap = mallinfo2();
  return double(heap.uordblks + heap.hblkhd) / (1 << 20);
}

}  // namespace

HistoryCost bench_history(const Common& common, Report& report, int edits) {
  using Clock = std::chrono::steady_clock;
  Session session(common, report, {});
  const auto muscles = session.document().muscles;
  const double before = heap_megabytes();
  for (int k = 0; k < edits; ++k)
    session.run_line(fmt::format("move_point {} point=1 by=0,0,0.5",
                                 muscles[std::size_t(k) % muscles.size()]->left.name));
  HistoryCost out;
  out.megabytes = heap_megabytes() - before;
  for (int k = 0; k < edits; ++k) {
    const Clock::time_point begin = Clock::now();
    session.run_line("undo");
    out.longest_undo =
        std::max(out.longest_undo, std::chrono::duration<double>(Clock::now() - begin).count());
  }
  return out;
}

}  // namespace ecorche
