#include "skinning/motion_files/skeleton_beside.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <system_error>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"

namespace ecorche::inline v1 {
namespace {

namespace fs = std::filesystem;

constexpr int kMostEntries = 100000;  // of a folder that is looked through

// Skeletons of the folder by their names, without what is before them and their endings.
std::map<std::string, fs::path> skeletons_in(const fs::path& folder, const SkeletonNames& names) {
  std::map<std::string, fs::path> out;
  std::error_code code;
  int left = kMostEntries;
  for (fs::directory_iterator at(folder, code), end; !code && at != end && left > 0;
       at.increment(code), --left) {
    const fs::path& file = at->path();
    std::string ending = file.extension().string(), stem = file.stem().string();
    std::ranges::transform(ending, ending.begin(),
                           [](unsigned char c) { return char(std::tolower(c)); });
    std::error_code none;
    if (std::ranges::find(names.endings, ending) == names.endings.end() ||
        !at->is_regular_file(none))
      continue;
    if (!names.before.empty()) {
      if (!stem.starts_with(names.before)) continue;
      stem.erase(0, names.before.size());
    }
    out.try_emplace(stem, file);
  }
  return out;
}

}  // namespace

fs::path skeleton_beside(const fs::path& motion, const SkeletonNames& names) {
  const fs::path folder = motion.has_parent_path() ? motion.parent_path() : fs::path(".");
  const std::map<std::string, fs::path> found = skeletons_in(folder, names);
  std::string stem = motion.stem().string();
  while (true) {
    if (const auto at = found.find(stem); at != found.end()) return at->second;
    const std::size_t bar = stem.rfind('_');
    if (bar == std::string::npos) break;
    stem.resize(bar);
  }
  if (found.size() == 1) return found.begin()->second;
  throw InputError(fmt::format(
      "{}: it needs {}; {} of that name lies beside it; name it with --skeleton FILE",
      printable(motion.string()), names.what,
      found.empty() ? std::string("none") : fmt::format("none of the {}", found.size())));
}

}  // namespace ecorche::inline v1
