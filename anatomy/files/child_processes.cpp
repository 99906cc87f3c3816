#include "anatomy/files/child_processes.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <unistd.h>

#include <cstdlib>
#include <mutex>
#include <set>
#include <system_error>
#include <utility>

extern char** environ;

namespace ecorche::inline v1 {
namespace {

struct Children {
  std::mutex mutex;
  std::set<pid_t> running;
};

Children& children() {
  static Children* const all = new Children;  // never destroyed: threads may still ask at exit
  return *all;
}

}  // namespace

ChildProcess::ChildProcess(pid_t pid) : pid_(pid) {
  const std::lock_guard lock(children().mutex);
  children().running.insert(pid_);
}

ChildProcess::~ChildProcess() { ended(); }

ChildProcess::ChildProcess(ChildProcess&& other) noexcept : pid_(std::exchange(other.pid_, -1)) {}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
  if (this != &other) {
    ended();
    pid_ = std::exchange(other.pid_, -1);
  }
  return *this;
}

void ChildProcess::ended() {
  if (pid_ < 0) return;
  const std::lock_guard lock(children().mutex);
  children().running.erase(pid_);
  pid_ = -1;
}

std::optional<std::filesystem::path> find_program(const char* variable, const char* name) {
  if (const char* named = std::getenv(variable); named && *named) return named;
  std::error_code failed;
  const std::filesystem::path folder =
      std::filesystem::read_symlink("/proc/self/exe", failed).parent_path();
  for (const auto& place : {folder / name, folder.parent_path() / name})
    if (std::filesystem::exists(place, failed)) return place;
  return std::nullopt;
}

ChildProcess start_program(const std::vector<std::string>& words, int in, int out, int err) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const int streams[] = {in, out, err};
  for (int i = 0; i < 3; ++i) {
    if (streams[i] >= 0)
      posix_spawn_file_actions_adddup2(&actions, streams[i], i);
    else
      posix_spawn_file_actions_addopen(&actions, i, "/dev/null", i == 0 ? O_RDONLY : O_WRONLY, 0);
  }
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  pid_t pid = -1;
  const int failure =
      posix_spawnp(&pid, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) throw std::system_error(failure, std::generic_category(), words[0]);
  return ChildProcess(pid);
}

void kill_child_processes() {
  const std::lock_guard lock(children().mutex);
  for (const pid_t pid : children().running) ::kill(-pid, SIGKILL);
}

}  // namespace ecorche::inline v1
