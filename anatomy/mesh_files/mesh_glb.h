// Meshes of any format as a .glb, so that all that follows knows one format.
#pragma once

#include <string>

#include "anatomy/mesh_files/mesh_file.h"

namespace ecorche::inline v1 {

// A node and a mesh a part, coordinates as they stand (single precision), with normals, colours and
// texture coordinates where there are any. Vertices keep their order; those that a seam of the
// texture gives several places are repeated after the last. Throws LimitError beyond 4 GB.
// Precondition: at least one part has faces; parts without are left out.
std::string mesh_glb(const MeshFile& file);

}  // namespace ecorche::inline v1
