#include "anatomy/cache.h"

#include <cstdlib>
#include <filesystem>

#include "anatomy/atomic_file.h"
#include "anatomy/errors.h"
#include "anatomy/input_file.h"

namespace ecorche {

namespace fs = std::filesystem;

fs::path cache_folder() {
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg && *xdg) return fs::path(xdg) / "ecorche";
  if (const char* home = std::getenv("HOME"); home && *home) return fs::path(home) / ".cache" / "ecorche";
  return {};
}

std::optional<std::string> read_cached(const std::string& name) {
  const fs::path folder = cache_folder();
  std::error_code missing;
  if (folder.empty() || !fs::exists(folder / name, missing)) return std::nullopt;
  try {
    return read_input_file(folder / name);
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
    write_file_atomically(folder / name, bytes);
  } catch (const OutputError&) {
  } catch (const fs::filesystem_error&) {
  }
}

}  // namespace ecorche
