#include "app/studio/design/frame_times.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace ecorche {
namespace {

constexpr const char* kDoing[] = {"still", "turning", "playing", "editing", "undoing"};

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

void FrameTimes::add(Doing doing, double seconds, bool fitting) {
  ms_[std::size_t(doing)].push_back(1e3 * seconds);
  if (fitting) fitting_.push_back(1e3 * seconds);
}

void FrameTimes::report(Report& report) const {
  for (std::size_t k = 0; k < ms_.size(); ++k) report_times(kDoing[k], ms_[k], report);
  report_times("while_fitting", fitting_, report);
}

}  // namespace ecorche
