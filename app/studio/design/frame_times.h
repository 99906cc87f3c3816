// Times from the reading of events until what they did is on the screen, by what was done.
#pragma once

#include <array>
#include <ctime>
#include <optional>
#include <vector>

#include "app/report.h"

namespace ecorche {

class FrameTimes {
 public:
  enum class Doing { still, turning, playing, editing, undoing };
  void begin();  // of a frame's work
  void end(Doing doing, double seconds, bool fitting);
  // window.turning.p50_ms and the like; nothing for what was not done. cpu_ms, cpu_p95_ms: of what
  // all threads together worked for it, where no fit worked beside it. While one did: by the clock,
  // and what the window's own thread worked (own_most_ms). The first frame, which makes the
  // pictures' programs before anything is seen, is window.first_ms alone.
  void report(Report& report) const;

 private:
  std::array<std::vector<double>, 5> ms_, cpu_ms_;
  std::clock_t began_ = 0;
  double own_began_ = 0;  // CPU time of the window's thread, s
  std::optional<double> first_ms_;
  std::vector<double> fitting_, own_;  // frames while a body was being fitted
};

}  // namespace ecorche
