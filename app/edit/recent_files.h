// Bodies, motions and projects that sessions had, for the next ones.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace ecorche {

struct RecentFile {
  std::string kind;  // body, motion or project
  std::filesystem::path file;
};

// Those that are still there, the latest first. `folder`: of the studio's states; empty: none.
std::vector<RecentFile> recent_files(const std::filesystem::path& folder);

// Puts it first; the oldest beyond twenty go. Does nothing where the folder cannot be written.
void note_recent(const std::filesystem::path& folder, const RecentFile& file);

}  // namespace ecorche
