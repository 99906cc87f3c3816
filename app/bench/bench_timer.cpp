#include "app/bench/bench_timer.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace ecorche {
namespace {

double seconds_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

double time_of(const BenchCase& bench, int repeats, clockid_t clock) {
  const double start = seconds_of(clock);
  for (int i = 0; i < repeats; ++i) bench.run();
  return (seconds_of(clock) - start) / repeats;
}

std::vector<double> least_times(std::span<const BenchCase> cases, int rounds, clockid_t clock) {
  constexpr double kShortest = 1e-3;
  std::vector<int> repeats;
  for (const BenchCase& bench : cases) {
    bench.run();  // warms caches and sizes buffers
    const double once = std::max(time_of(bench, 1, clock), 1e-7);
    repeats.push_back(int(std::clamp(std::ceil(kShortest / once), 1.0, 1000.0)));
  }
  std::vector<double> least(cases.size(), std::numeric_limits<double>::infinity());
  for (int round = 0; round < rounds; ++round)
    for (size_t i = 0; i < cases.size(); ++i)
      least[i] = std::min(least[i], time_of(cases[i], repeats[i], clock));
  return least;
}

}  // namespace

std::vector<double> least_cpu_times(std::span<const BenchCase> cases, int rounds) {
  return least_times(cases, rounds, CLOCK_THREAD_CPUTIME_ID);
}

std::vector<double> least_clock_times(std::span<const BenchCase> cases, int rounds) {
  return least_times(cases, rounds, CLOCK_MONOTONIC);
}

}  // namespace ecorche
