// The vertices about each vertex of a triangle mesh.
#pragma once

#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Vertices that share an edge with each, ascending, each once. #V
std::vector<std::vector<int>> vertex_neighbours(const TriMesh& mesh);

}  // namespace ecorche::inline v1
