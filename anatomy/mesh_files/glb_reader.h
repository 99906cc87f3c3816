// The meshes of a glTF file, .glb or .gltf. Private to mesh_io, whose exceptions it throws.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "anatomy/mesh_files/mesh_file.h"

namespace ecorche::inline v1 {

// Appends parts and notes to `out`; `name` stands for the file in messages; `folder`: where its
// buffers outside lie. A node with a mesh is a part, in the world's frame, with the morph targets
// that the file weighs.
void parse_glb(std::string_view bytes, const std::string& name,
               const std::optional<std::filesystem::path>& folder, const MeshReadOptions& options,
               MeshFile& out);

}  // namespace ecorche::inline v1
