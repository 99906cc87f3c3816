// What readers gather of vertices, as a MeshPart has it. Private to the readers.
#pragma once

#include <vector>

#include "anatomy/mesh_files/mesh_file.h"

namespace ecorche::inline v1 {

// Of unit length; zero rows stay zero.
Points unit_normals(const std::vector<double>& xyz);

// As 0 .. 1: divided by 255 where a value lies above 1, and held to that range.
Colours colours_in_range(const std::vector<float>& rgb);

// Each corner's, of values of the vertices; u and v of each.
TextureCoordinates corner_texture(const std::vector<float>& uv, const Triangles& F);

}  // namespace ecorche::inline v1
