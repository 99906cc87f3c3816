// Times from the reading of events until what they did is on the screen, by what was done.
#pragma once

#include <array>
#include <ctime>
#include <vector>

#include "app/report.h"

namespace ecorche {

class FrameTimes {
 public:
  enum class Doing { still, turning, playing, editing, undoing };
  void begin();  // of a frame's work
  void end(Doing doing, double seconds, bool fitting);
  // window.turning.p50_ms and the like; nothing for what was not done. cpu_ms: the median of what
  // all threads together worked for it, where no fit worked beside it.
  void report(Report& report) const;

 private:
  std::array<std::vector<double>, 5> ms_, cpu_ms_;
  std::clock_t began_ = 0;
  std::vector<double> fitting_;  // frames while a body was being fitted
};

}  // namespace ecorche
