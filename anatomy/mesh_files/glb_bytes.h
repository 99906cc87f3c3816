// Private to the writers of .glb: the container.
#pragma once

#include <string>
#include <string_view>

namespace ecorche::inline v1 {

// A .glb of JSON and a binary chunk, both padded as the format asks. Throws LimitError beyond 4 GB.
std::string glb_bytes(std::string_view json, std::string_view binary);

}  // namespace ecorche::inline v1
