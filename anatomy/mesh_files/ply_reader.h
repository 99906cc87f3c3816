// PLY: ASCII, binary of either byte order. Private to mesh_io, whose exceptions it throws.
#pragma once

#include <string>
#include <string_view>

#include "anatomy/mesh_files/mesh_file.h"

namespace ecorche::inline v1 {

// Appends parts and notes to `out`; `name` stands for the file in messages.
void parse_ply(std::string_view bytes, const std::string& name, const MeshReadOptions& options,
               MeshFile& out);

}  // namespace ecorche::inline v1
