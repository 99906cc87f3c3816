// How far long work is, and how long it will still take.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "app/verb.h"

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

  // From any thread. Numbers rise; one that came late is passed over. `stage`: what is being done,
  // where there are several things.
  void at(int done, const char* stage = "");
  // One more is done.
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

// "about 12 s left", "about 3 min left"; empty where too little is known: less than a second has
// passed.
std::string time_left(double seconds_passed, double share_done);

}  // namespace ecorche
