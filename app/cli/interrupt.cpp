#include "app/cli/interrupt.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <string>

#include "anatomy/files/atomic_file.h"
#include "anatomy/files/cache.h"
#include "anatomy/files/child_processes.h"

namespace ecorche {
namespace {

constexpr int kWatched[] = {SIGINT, SIGTERM, SIGHUP};

bool is_ignored(int signal) {
  struct sigaction now;
  return sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
}

// SIGUSR1 ends the watching thread at the end of the program.
sigset_t watched_signals() {
  sigset_t out;
  sigemptyset(&out);
  for (const int signal : kWatched)
    if (!is_ignored(signal)) sigaddset(&out, signal);
  sigaddset(&out, SIGUSR1);
  return out;
}

// Files of the cache are not outputs.
std::string list_outputs(const std::vector<std::filesystem::path>& files) {
  const std::string cache = cache_folder().string();
  std::string out;
  for (const std::filesystem::path& file : files)
    if (cache.empty() || !file.string().starts_with(cache))
      out += (out.empty() ? "" : ", ") + file.string();
  return out;
}

void end_run(int signal) {
  kill_child_processes();
  const WrittenFiles files = abandon_writing();
  const std::string complete = list_outputs(files.complete);
  const std::string abandoned = list_outputs(files.abandoned);
  std::string text = signal == SIGINT ? "\necorche: interrupted" : "\necorche: terminated";
  text += complete.empty() ? "; nothing was written" : "; written and complete: " + complete;
  if (!abandoned.empty()) text += "; not written: " + abandoned;
  text += "\n";
  [[maybe_unused]] const ssize_t told = write(STDERR_FILENO, text.data(), text.size());
  _exit(128 + signal);
}

}  // namespace

InterruptWatch::InterruptWatch() {
  const sigset_t signals = watched_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  watch_ = std::thread([signals] {
    int signal = 0;
    while (sigwait(&signals, &signal) != 0) continue;
    if (signal != SIGUSR1) end_run(signal);
  });
}

InterruptWatch::~InterruptWatch() {
  pthread_kill(watch_.native_handle(), SIGUSR1);
  watch_.join();
}

}  // namespace ecorche
