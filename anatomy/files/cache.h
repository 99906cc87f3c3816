// Files that spare making again what takes long: named by a hash of all that they were made from,
// so that they are never stale.
//
// In $XDG_CACHE_HOME/ecorche, else ~/.cache/ecorche, else nowhere. A cache that cannot be read or
// written costs time, nothing else. Each file states its own name in its first line, and its
// content a hash of itself (anatomy/files/byte_stream.h: sealed), so that neither a damaged file
// nor another's under its name is believed.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace ecorche::inline v1 {

// The folder; empty where the environment names none.
std::filesystem::path cache_folder();

// Nothing when there is none, it cannot be read, or it states another name. `bytes` are sealed.
std::optional<std::string> read_cached(const std::string& name);
void write_cached(const std::string& name, std::string_view bytes);

}  // namespace ecorche::inline v1
