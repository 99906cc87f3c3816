// Pieces of a mesh that do not touch.
#pragma once

#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// The lowest vertex of each vertex's island, vertices at one place taken as one: seams of texture
// coordinates part nothing. A vertex without faces is an island. #V
// Precondition: corners in range.
std::vector<int> mesh_islands(const TriMesh& mesh);

}  // namespace ecorche::inline v1
