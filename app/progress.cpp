#include "app/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace ecorche {
namespace {

constexpr int kWidth = 32;           // characters of the bar
constexpr double kBarSeconds = 0.1;  // between two drawings
constexpr double kLineSeconds = 5;   // between two lines

}  // namespace

std::string time_left(double seconds_passed, double share_done) {
  if (seconds_passed < 1 || share_done <= 0 || share_done >= 1) return {};
  const double left = seconds_passed * (1 - share_done) / share_done;
  if (left < 99) return fmt::format("about {:.0f} s left", std::ceil(left));
  if (left < 99 * 60) return fmt::format("about {:.0f} min left", std::ceil(left / 60));
  return fmt::format("about {:.1f} h left", left / 3600);
}

Progress::Progress(const Common& common, std::string what, int total)
    : what_(std::move(what)),
      total_(total),
      start_(Clock::now()),
      shown_(start_ - std::chrono::hours(1)) {
  if (common.quiet || total <= 0 || common.progress == "never") return;
  if (common.progress == "lines")
    kind_ = Kind::lines, shown_ = start_;
  else if (isatty(STDERR_FILENO) != 0)
    kind_ = Kind::bar;
}

Progress::~Progress() {
  if (open_) std::fputc('\n', stderr);
}

void Progress::at(int done, const char* stage) {
  const std::lock_guard lock(mutex_);
  advance(done, stage);
}

void Progress::step() {
  const std::lock_guard lock(mutex_);
  advance(done_ + 1, "");
}

void Progress::advance(int done, const char* stage) {
  if (kind_ == Kind::none || done <= done_) return;
  done_ = done;
  const Clock::time_point now = Clock::now();
  const double since = std::chrono::duration<double>(now - shown_).count();
  if (done < total_ && since < (kind_ == Kind::bar ? kBarSeconds : kLineSeconds)) return;
  shown_ = now;
  show(done, stage, std::chrono::duration<double>(now - start_).count());
}

void Progress::show(int done, const char* stage, double seconds) {
  const std::string left =
      done >= total_ ? fmt::format("{:.1f} s", seconds) : time_left(seconds, double(done) / total_);
  if (kind_ == Kind::lines) {
    std::fprintf(stderr, "%s\n",
                 fmt::format("{}: {} of {}{}{}{}{}", what_, done, total_, left.empty() ? "" : ", ",
                             left, *stage ? ", " : "", stage)
                     .c_str());
    return;
  }
  const int filled = static_cast<long long>(kWidth) * done / total_;
  std::fprintf(
      stderr, "\r%s\033[K",
      fmt::format("{:<18} [{:<{}}] {}/{}  {}{}{}", what_, std::string(std::size_t(filled), '='),
                  kWidth, done, total_, left, *stage ? "  " : "", stage)
          .c_str());
  open_ = done < total_;
  if (!open_) std::fputc('\n', stderr);
  std::fflush(stderr);
}

}  // namespace ecorche
