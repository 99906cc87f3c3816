#include "anatomy/files/cache.h"

#include <cstdlib>
#include <filesystem>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/files/input_file.h"

namespace ecorche::inline v1 {

namespace fs = std::filesystem;

fs::path cache_folder() {
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg && *xdg)
    return fs::path(xdg) / "ecorche";
  if (const char* home = std::getenv("HOME"); home && *home)
    return fs::path(home) / ".cache" / "ecorche";
  return {};
}

namespace {

// What a cache file begins with, so that one under another's name is seen for what it is.
std::string first_line(const std::string& name) { return "ecorche cache " + name + "\n"; }

}  // namespace

std::optional<std::string> read_cached(const std::string& name) {
  const fs::path folder = cache_folder();
  std::error_code missing;
  if (folder.empty() || !fs::exists(folder / name, missing)) return std::nullopt;
  try {
    std::string bytes = read_input_file(folder / name);
    const std::string line = first_line(name);
    if (!bytes.starts_with(line)) return std::nullopt;
    return bytes.erase(0, line.size());
  } catch (const InputError&) {
    return std::nullopt;
  } catch (const LimitError&) {
    return std::nullopt;
  }
}

void write_cached(const std::string& name, std::string_view bytes) {
  const fs::path folder = cache_folder();
  if (folder.empty()) return;
  try {
    fs::create_directories(folder);
    write_file_atomically(folder / name, first_line(name).append(bytes));
  } catch (const OutputError&) {
  } catch (const fs::filesystem_error&) {
  }
}

}  // namespace ecorche::inline v1
