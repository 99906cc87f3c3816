// OFF, text: with colours (COFF), normals (NOFF), texture coordinates (STOFF). Private to mesh_io,
// whose exceptions it throws.
#pragma once

#include <string>
#include <string_view>

#include "anatomy/mesh_files/mesh_file.h"

namespace ecorche::inline v1 {

// Whether a word opens an OFF file: OFF, COFF, NOFF, CNOFF, STOFF, 4OFF ...
bool is_off_keyword(std::string_view word);

// Appends parts and notes to `out`; `name` stands for the file in messages. Source of the format:
// Geomview's manual, OOGL file formats.
void parse_off(std::string_view text, const std::string& name, const MeshReadOptions& options,
               MeshFile& out);

}  // namespace ecorche::inline v1
