// The meshes of a glTF file in binary form. Private to mesh_io, whose exceptions it throws.
#pragma once

#include <string>
#include <string_view>

#include "anatomy/mesh_files/mesh_file.h"

namespace ecorche::inline v1 {

// Appends parts and notes to `out`; `name` stands for the file in messages.
void parse_glb(std::string_view bytes, const std::string& name, MeshFile& out);

}  // namespace ecorche::inline v1
