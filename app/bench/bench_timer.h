// Comparable times: the least CPU time of interleaved repetitions, so that other load on the
// machine changes ratios little.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace ecorche {

struct BenchCase {
  std::string name;
  std::function<void()> run;
};

// Seconds of CPU time of the calling thread, the least of `rounds` rounds; each round runs every
// case once, in turn. Cases that last less than a millisecond are repeated inside a round until
// they fill one.
std::vector<double> least_cpu_times(std::span<const BenchCase> cases, int rounds);

// The same in wall time, for multithreaded cases; includes other load on the machine.
std::vector<double> least_clock_times(std::span<const BenchCase> cases, int rounds);

}  // namespace ecorche
