// Surfaces of bones as they are drawn, wrapped and measured: closed, outward, of even fineness.
#pragma once

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Packages come with bones of holes, of triangles that face either way, of edges from half a
// millimetre to five centimetres. Their triangles are turned alike and holes closed. Where edges
// are much longer than a fiftieth of the bone's size (1 to 4 mm), the mesh is refined once by
// modified butterfly subdivision (Zorin et al. 1996, 10.1145/237170.237254), which keeps its
// vertices and rounds what lies between; where they are much shorter, it is simplified
// (simplify.h). Precondition: `mesh` has a triangle; F indexes V; V is finite, m.
TriMesh bone_surface(const TriMesh& mesh);

}  // namespace ecorche::inline v1
