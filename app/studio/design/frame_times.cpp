#include "app/studio/design/frame_times.h"

#include <fmt/format.h>

#include <time.h>

#include <algorithm>
#include <string>

namespace ecorche {
namespace {

constexpr const char* kDoing[] = {"still", "turning", "playing", "editing", "undoing"};

// CPU time of this thread.
double own_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

void report_times(const std::string& name, std::vector<double> ms, Report& report) {
  if (ms.empty()) return;
  std::ranges::sort(ms);
  const auto at = [&](double share) { return ms[std::size_t(share * double(ms.size() - 1))]; };
  report.set(fmt::format("window.{}.frames", name), int(ms.size()));
  report.set(fmt::format("window.{}.p50_ms", name), at(0.5));
  report.set(fmt::format("window.{}.p95_ms", name), at(0.95));
  report.set(fmt::format("window.{}.most_ms", name), ms.back());
}

}  // namespace

void FrameTimes::begin() {
  began_ = std::clock();
  own_began_ = own_seconds();
}

void FrameTimes::end(Doing doing, double seconds, bool fitting) {
  if (!first_ms_) {
    first_ms_ = 1e3 * seconds;
    return;
  }
  if (fitting) own_.push_back(1e3 * (own_seconds() - own_began_));
  if (!fitting)
    cpu_ms_[std::size_t(doing)].push_back(1e3 * double(std::clock() - began_) / CLOCKS_PER_SEC);
  ms_[std::size_t(doing)].push_back(1e3 * seconds);
  if (fitting) fitting_.push_back(1e3 * seconds);
}

void FrameTimes::report(Report& report) const {
  for (std::size_t k = 0; k < ms_.size(); ++k) {
    report_times(kDoing[k], ms_[k], report);
    std::vector<double> cpu = cpu_ms_[k];
    if (cpu.empty()) continue;
    std::ranges::sort(cpu);
    report.set(fmt::format("window.{}.cpu_ms", kDoing[k]), cpu[cpu.size() / 2]);
    report.set(fmt::format("window.{}.cpu_p95_ms", kDoing[k]),
               cpu[std::size_t(0.95 * double(cpu.size() - 1))]);
  }
  report_times("while_fitting", fitting_, report);
  if (!own_.empty())
    report.set("window.while_fitting.own_most_ms", *std::ranges::max_element(own_));
  if (first_ms_) report.set("window.first_ms", *first_ms_);
}

}  // namespace ecorche
