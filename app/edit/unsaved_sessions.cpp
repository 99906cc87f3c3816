#include "app/edit/unsaved_sessions.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <utility>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "app/edit/journal.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

fs::path folder_of_variable(const char* name) {
  const char* value = std::getenv(name);
  const fs::path out = value ? value : "";
  return out.is_absolute() ? out : fs::path();
}

std::time_t last_change(const fs::path& file) {
  struct stat seen {};
  return stat(file.c_str(), &seen) == 0 ? seen.st_mtime : 0;
}

}  // namespace

fs::path unsaved_sessions_folder() {
  if (const fs::path state = folder_of_variable("XDG_STATE_HOME"); !state.empty())
    return state / "ecorche" / "studio";
  if (const fs::path home = folder_of_variable("HOME"); !home.empty())
    return home / ".local" / "state" / "ecorche" / "studio";
  return {};
}

std::vector<UnsavedSession> unsaved_sessions(const fs::path& folder) {
  std::vector<std::pair<std::time_t, UnsavedSession>> found;
  std::error_code unreadable;
  for (const auto& entry : fs::directory_iterator(folder, unreadable)) {
    const fs::path journal = entry.path() / kJournalFile;
    const std::vector<std::string> lines = read_journal(journal);
    const int count = int(lines.size()) - int(begin_of_journal(lines).line);
    // one without a line may be about to lock it
    if (lines.empty() || is_journal_held(journal)) continue;
    const std::time_t changed = last_change(journal);
    std::tm local{};
    localtime_r(&changed, &local);
    found.push_back({changed,
                     {entry.path(), entry.path().filename().string(),
                      fmt::format("{:%Y-%m-%d %H:%M}", local), count}});
  }
  std::ranges::sort(found, [](const auto& a, const auto& b) {
    return std::pair(a.first, a.second.name) > std::pair(b.first, b.second.name);
  });
  std::vector<UnsavedSession> out;
  for (auto& each : found) out.push_back(std::move(each.second));
  return out;
}

UnsavedSession find_unsaved_session(const fs::path& folder, const std::string& name) {
  const std::vector<UnsavedSession> all = unsaved_sessions(folder);
  std::vector<std::string> names;
  for (const UnsavedSession& session : all) {
    if (name == "last" || name == session.name) return session;
    names.push_back(session.name);
  }
  if (names.empty()) throw InputError("no unsaved session was left behind");
  throw InputError(
      fmt::format("'{}': no such unsaved session; there are {}", name, fmt::join(names, ", ")));
}

fs::path make_unsaved_session(const fs::path& folder) {
  if (folder.empty())
    throw OutputError("there is no folder for it: neither XDG_STATE_HOME nor HOME is set");
  make_output_folder(folder);
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::string made = (folder / fmt::format("{:%Y%m%d-%H%M%S}-XXXXXX", utc)).string();
  if (!mkdtemp(made.data()))
    throw OutputError(fmt::format("{}: {}", folder.string(), std::strerror(errno)));
  return made;
}

void forget_unsaved_session(const fs::path& session) {
  if (is_journal_held(session / kJournalFile)) return;
  std::error_code left;
  fs::remove_all(session, left);
}

std::string unsaved_session_text(const UnsavedSession& session) {
  return fmt::format("{}, {} action{}", session.until, session.lines,
                     session.lines == 1 ? "" : "s");
}

}  // namespace ecorche
