// Area-weighted vertex normals of a deformed skin.
#pragma once

#include <span>

#include "anatomy/types.h"

namespace ecorche {

// positions, normals: 4 floats a vertex. triangles: 3 indices each. Vertices of no triangle get a zero normal.
void vertex_normals(std::span<const float> positions, std::span<const int> triangles, std::span<float> normals);

}  // namespace ecorche
