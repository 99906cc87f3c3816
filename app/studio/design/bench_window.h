// Times of the studio's window, for `ecorche bench --studio`.
#pragma once

#include <string>
#include <vector>

#include "app/common_options.h"
#include "app/report.h"

namespace ecorche {

struct WindowLine {
  std::string name, what;
  double ms = 0, asked = 0;  // by the clock
};

// Plays a session at a window of 1280 x 720 with the template's body: the view turns, a point of a
// muscle is dragged and taken back, a body is fitted meanwhile, a walk plays under a faint skin.
// `report` gets all figures of the session. Throws OutputError where there is no display.
std::vector<WindowLine> bench_window(const Common& common, Report& report);

}  // namespace ecorche
