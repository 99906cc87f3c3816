// Triangle meshes and clouds of points from files: OBJ, PLY (ASCII, binary of either byte order),
// STL, OFF, PCD, glTF (.glb, .gltf), FBX and COLLADA (both by scene_import.h); OBJ and PLY to
// files.
//
// The first bytes tell the format, not the file's ending. Numbers are taken as they stand, except
// those of FBX and COLLADA, which come in metres with +Y up: units and axes are the caller's.
// Nothing that a file names is ever opened (materials, textures), except a .gltf's buffers in its
// own folder. Polygons are cut into triangles. Compressed glTF (Draco, meshopt) is refused.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "anatomy/mesh_files/mesh_file.h"
#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Throws InputError that names file and line or element (malformed, truncated, not finite, index
// out of range), UnfitError (no faces unless clouds are asked for, faces of a kind that is not
// read), LimitError (2^27 vertices or faces, polygons of 10,000 corners).
MeshFile read_mesh_file(const std::filesystem::path& file, const MeshReadOptions& options = {});

// As above from memory; `name` is what messages call it. Buffers outside are refused.
MeshFile parse_mesh(std::string_view bytes, const std::string& name,
                    const MeshReadOptions& options = {});

// All parts as one mesh.
TriMesh all_parts(const MeshFile& file);
TriMesh read_mesh(const std::filesystem::path& file);

// Coordinates survive exactly. Throws OutputError; never leaves half a file.
void write_obj(const std::filesystem::path& file, const TriMesh& mesh);
void write_ply(const std::filesystem::path& file,
               const TriMesh& mesh);  // binary little endian, double

}  // namespace ecorche::inline v1
