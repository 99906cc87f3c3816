// Files from outside, read whole.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace ecorche {

// Throws InputError for what is missing, empty, unreadable or no regular file (a FIFO is never waited on), LimitError above `limit` bytes.
std::string read_input_file(const std::filesystem::path& file, std::size_t limit = std::size_t{2} << 30);

// The name as messages show it: control characters replaced.
std::string printable(const std::string& text);

}  // namespace ecorche
