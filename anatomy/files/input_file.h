// Files from outside, read whole.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "anatomy/limits.h"

namespace ecorche::inline v1 {

// Throws InputError "FILE: reason" with the system's own words for what is missing, forbidden, a
// folder or a ring of links, and for what is empty or no regular file (a pipe is never waited on);
// LimitError above `limit` bytes.
std::string read_input_file(const std::filesystem::path& file,
                            std::size_t limit = limits::kFileBytes);

// Throws as read_input_file for a file that it would refuse, but reads nothing: for those who read
// a part of a large file.
void check_input_file(const std::filesystem::path& file);

// The file that a text inside `folder` means by `name`, a plain file name. Throws InputError
// "WHERE: reason" for anything that leads elsewhere: a path, a link out of the folder, nothing.
std::filesystem::path file_beside(const std::filesystem::path& folder, const std::string& name,
                                  const std::string& where);

// The text as messages and names show it: control characters and what is not UTF-8 replaced by '?'.
std::string printable(std::string_view text);
bool is_utf8(std::string_view text);

}  // namespace ecorche::inline v1
