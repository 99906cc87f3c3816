#include "app/bench_timer.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace ecorche {
namespace {

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double time_of(const BenchCase& bench, int repeats) {
  const double start = cpu_seconds();
  for (int i = 0; i < repeats; ++i) bench.run();
  return (cpu_seconds() - start) / repeats;
}

}  // namespace

std::vector<double> least_cpu_times(std::span<const BenchCase> cases, int rounds) {
  constexpr double kShortest = 1e-3;
  std::vector<int> repeats;
  for (const BenchCase& bench : cases) {
    bench.run();  // warms caches and sizes buffers
    const double once = std::max(time_of(bench, 1), 1e-7);
    repeats.push_back(static_cast<int>(std::clamp(std::ceil(kShortest / once), 1.0, 1000.0)));
  }
  std::vector<double> least(cases.size(), std::numeric_limits<double>::infinity());
  for (int round = 0; round < rounds; ++round)
    for (size_t i = 0; i < cases.size(); ++i) least[i] = std::min(least[i], time_of(cases[i], repeats[i]));
  return least;
}

}  // namespace ecorche
