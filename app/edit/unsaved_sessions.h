// Journals of sessions that have no project: each in a folder of its own, below that of the user's
// program states. What a session that was killed has left there can be taken up by another.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace ecorche {

// $XDG_STATE_HOME/ecorche/studio, else ~/.local/state/ecorche/studio; empty where neither is
// an absolute path.
std::filesystem::path unsaved_sessions_folder();

struct UnsavedSession {
  std::filesystem::path folder;
  std::string name;   // of the folder: when it began (UTC) and a few letters
  std::string until;  // its last action, local time: 2024-05-31 17:02
  int lines = 0;      // of its journal that count
};
// Those with actions whose session runs no more, the latest first. None where the folder cannot be
// read.
std::vector<UnsavedSession> unsaved_sessions(const std::filesystem::path& folder);

// By its name, or `last`. Throws InputError that tells the names there are.
UnsavedSession find_unsaved_session(const std::filesystem::path& folder, const std::string& name);

// A new folder within, which no other session has. Throws OutputError with the system's reason.
std::filesystem::path make_unsaved_session(const std::filesystem::path& folder);

// Nothing where a running session has it, or it is gone.
void forget_unsaved_session(const std::filesystem::path& session);

// 2024-05-31 17:02, 14 actions
std::string unsaved_session_text(const UnsavedSession& session);

}  // namespace ecorche
