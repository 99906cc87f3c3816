#include "app/edit/recent_files.h"

#include <algorithm>
#include <fstream>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRecentFile = "recent.txt";
constexpr std::size_t kMostRecent = 20;

bool is_kind(const std::string& word) {
  return word == "body" || word == "motion" || word == "project";
}

}  // namespace

std::vector<RecentFile> recent_files(const fs::path& folder) {
  std::vector<RecentFile> out;
  if (folder.empty()) return out;
  std::ifstream in(folder / kRecentFile);
  for (std::string line; out.size() < kMostRecent && std::getline(in, line);) {
    const std::size_t blank = line.find(' ');
    if (blank == std::string::npos || !is_kind(line.substr(0, blank))) continue;
    const fs::path file = line.substr(blank + 1);
    std::error_code ignored;
    if (file.is_absolute() && fs::exists(file, ignored))
      out.push_back({line.substr(0, blank), file});
  }
  return out;
}

void note_recent(const fs::path& folder, const RecentFile& file) {
  if (folder.empty()) return;
  try {
    const fs::path whole = fs::absolute(file.file).lexically_normal();
    if (whole.string().find('\n') != std::string::npos) return;
    std::vector<RecentFile> all = recent_files(folder);
    std::erase_if(all, [&](const RecentFile& each) { return each.file == whole; });
    all.insert(all.begin(), {file.kind, whole});
    all.resize(std::min(all.size(), kMostRecent));
    std::string text;
    for (const RecentFile& each : all) text += each.kind + " " + each.file.string() + "\n";
    make_output_folder(folder);
    write_file_atomically(folder / kRecentFile, text);
  } catch (const Error&) {
    // a convenience: a session goes on without
  } catch (const fs::filesystem_error&) {
  }
}

}  // namespace ecorche
