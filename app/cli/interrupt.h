// Ctrl-C and SIGTERM: the run ends at once, removes unfinished files and lists the finished ones.
#pragma once

#include <thread>

namespace ecorche {

// From its construction on, SIGINT, SIGTERM and SIGHUP remove all temporaries, end all programs
// that were started, tell on stderr which outputs are complete and which are not there, and end the
// process with 128 + the signal's number. Construct it before any other thread exists: threads
// inherit the mask that keeps these signals from them. A signal that the parent process ignores
// (nohup) stays ignored.
class InterruptWatch {
 public:
  InterruptWatch();
  ~InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

 private:
  std::thread watch_;
};

}  // namespace ecorche
