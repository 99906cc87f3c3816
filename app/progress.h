// Progress of long computations, with the remaining time.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "app/common_options.h"

namespace ecorche {

// A bar on a terminal: "frames [=====     ] 120/240  12 s left". Silent in pipes and with -q; with
// --progress lines, a line every few seconds wherever stderr goes. Finished when done == total, or
// when it goes out of scope.
class Progress {
 public:
  Progress(const Common& common, std::string what, int total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Thread-safe. A number below an earlier one is ignored. `stage`: name of the current stage, if
  // there are several.
  void at(int done, const char* stage = "");
  // Counts one more as done.
  void step();

 private:
  using Clock = std::chrono::steady_clock;
  void advance(int done, const char* stage);
  void show(int done, const char* stage, double seconds);

  enum class Kind { none, bar, lines } kind_ = Kind::none;
  std::string what_;
  int total_ = 0, done_ = 0;
  std::mutex mutex_;
  Clock::time_point start_, shown_;
  bool open_ = false;  // a bar without its line end
};

// "about 12 s left", "about 3 min left"; empty during the first second.
std::string time_left(double seconds_passed, double share_done);

}  // namespace ecorche
