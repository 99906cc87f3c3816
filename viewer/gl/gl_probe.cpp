#include "viewer/gl/gl_probe.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <exception>

namespace ecorche {
namespace {

// Runs in the child; does not return.
[[noreturn]] void attempt_and_exit(const std::function<void()>& attempt, int answer) {
  for (const int death : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGTERM, SIGINT})
    signal(death, SIG_DFL);
  if (const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC); nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
  }
  std::string why;
  try {
    attempt();
  } catch (const std::exception& error) {
    why = error.what();
    if (why.empty()) why = "failed without a reason";
  } catch (...) {
    why = "failed without a reason";
  }
  const ssize_t written = write(answer, why.data(), why.size());
  _exit(written == static_cast<ssize_t>(why.size()) ? 0 : 1);
}

// Reads a pipe until it is closed; false if the time is over first.
bool read_all(int from, double seconds, std::string& text) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                                   std::chrono::duration<double>(seconds));
  std::array<char, 512> part{};
  while (true) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    pollfd ready{from, POLLIN, 0};
    if (left <= 0 || poll(&ready, 1, int(left)) == 0) return false;
    const ssize_t n = read(from, part.data(), part.size());
    if (n == 0) return true;
    if (n > 0) text.append(part.data(), std::size_t(n));
    if (n < 0 && errno != EINTR) return true;
  }
}

}  // namespace

std::string failure_in_child(const std::function<void()>& attempt, double seconds) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    return fmt::format("cannot be tried out: {}", std::strerror(errno));
  const pid_t copy = fork();
  if (copy == 0) attempt_and_exit(attempt, ends[1]);
  close(ends[1]);
  std::string why;
  const bool answered = copy > 0 && read_all(ends[0], seconds, why);
  close(ends[0]);
  if (copy < 0) return fmt::format("cannot be tried out: {}", std::strerror(errno));
  if (!answered) kill(copy, SIGKILL);
  int status = 0;
  while (waitpid(copy, &status, 0) < 0 && errno == EINTR) continue;
  if (!answered) return fmt::format("the driver did not answer within {:g} s", seconds);
  if (WIFSIGNALED(status))
    return fmt::format("the driver crashes ({})", strsignal(WTERMSIG(status)));
  if (WEXITSTATUS(status) != 0) return "the driver ended the process";
  return why;
}

}  // namespace ecorche
