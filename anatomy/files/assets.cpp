#include "anatomy/files/assets.h"

#include <dlfcn.h>

#include <cstdlib>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace fs = std::filesystem;

namespace {

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

// share/ecorche of the installations that the executable and the shared library with this function
// may be part of.
std::vector<fs::path> installed_folders() {
  std::vector<fs::path> binaries;
  std::error_code failure;
  if (const fs::path self = fs::read_symlink("/proc/self/exe", failure); !failure)
    binaries.push_back(self);
  Dl_info object{};
  // A name without a slash was found along PATH: it is the executable, and says no folder.
  if (dladdr(reinterpret_cast<const void*>(&open_assets), &object) != 0 && object.dli_fname &&
      std::string(object.dli_fname).find('/') != std::string::npos) {
    const fs::path library = fs::canonical(object.dli_fname, failure);
    if (!failure && (binaries.empty() || library != binaries[0])) binaries.push_back(library);
  }
  // bin/ecorche, lib/libecorche.so or lib/x86_64-linux-gnu/libecorche.so, all under one prefix.
  constexpr int kLevels = 3;
  std::vector<fs::path> out;
  for (const fs::path& binary : binaries) {
    fs::path above = binary.parent_path();
    for (int level = 1; level < kLevels && above.has_relative_path(); ++level) {
      above = above.parent_path();
      out.push_back(above / "share" / "ecorche");
    }
  }
  return out;
}

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

fs::path find_tables(const fs::path& folder) {
  std::vector<fs::path> places;
  if (!folder.empty()) {
    places.push_back(folder / "data");
    if (is_folder(places[0])) return places[0];
  }
  if (const std::string set = environment("ECORCHE_DATA"); !set.empty()) return set;
  for (const fs::path& share : installed_folders()) places.push_back(share / "data");
  places.emplace_back(ECORCHE_DATA_DIR);
  std::string tried;
  for (const fs::path& place : places) {
    if (is_folder(place)) return place;
    tried += (tried.empty() ? "" : ", ") + place.string();
  }
  throw InputError(fmt::format(
      "the folder of tables is missing (looked for {}); set ECORCHE_DATA to it", tried));
}

fs::path find_packages(const fs::path& folder) {
  if (!folder.empty() && is_folder(folder / "packages")) return folder / "packages";
  if (const std::string set = environment("ECORCHE_PACKAGES"); !set.empty()) return set;
  std::vector<fs::path> places;
  for (const fs::path& share : installed_folders()) places.push_back(share / "packages");
  const fs::path built = fs::path(ECORCHE_DATA_DIR).parent_path() / "build" / "packages";
  places.push_back(built);
  if (const std::string xdg = environment("XDG_DATA_HOME"); !xdg.empty()) {
    places.push_back(fs::path(xdg) / "ecorche" / "packages");
  } else if (const std::string home = environment("HOME"); !home.empty()) {
    places.push_back(fs::path(home) / ".local/share/ecorche/packages");
  }
  for (const fs::path& place : places)
    if (is_folder(place)) return place;
  return built;
}

}  // namespace

Assets open_assets(const fs::path& folder) {
  Assets assets;
  assets.tables = find_tables(folder);
  assets.packages = {find_packages(folder), assets.tables / "packages.txt"};
  return assets;
}

}  // namespace ecorche::inline v1
