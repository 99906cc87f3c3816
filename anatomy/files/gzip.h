// Decompression of gzip members held in memory.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace ecorche::inline v1 {

// Throws InputError "name: ..." for anything that is not a complete gzip stream, LimitError when it
// grows beyond `limit` bytes.
std::string gunzip(std::string_view bytes, const std::string& name,
                   std::size_t limit = std::size_t{256} << 20);

}  // namespace ecorche::inline v1
