// Programs that this one has started and that must not outlive it.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace ecorche::inline v1 {

// Remembers a child between its start and its end.
class ChildProcess {
 public:
  ChildProcess() = default;
  explicit ChildProcess(pid_t pid);
  ~ChildProcess();
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;

  pid_t pid() const { return pid_; }  // -1: none
  void ended();                       // it has been waited for

 private:
  pid_t pid_ = -1;
};

// A program of ours: the one that the environment's `variable` names, else the one that lies beside
// this program or in the folder above.
std::optional<std::filesystem::path> find_program(const char* variable, const char* name);

// Starts a program: words[0] with the rest as arguments, looked for in PATH unless it has a slash.
// `in`, `out`, `err`: descriptors that become its standard streams; -1: /dev/null. It leads a
// process group of its own, and no signal is blocked in it. Throws std::system_error where it
// cannot be started.
ChildProcess start_program(const std::vector<std::string>& words, int in, int out, int err);

// Ends them all, with what they have started, at once (SIGKILL), for a program that is itself about
// to end.
void kill_child_processes();

}  // namespace ecorche::inline v1
