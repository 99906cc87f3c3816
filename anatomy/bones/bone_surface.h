// Surfaces of bones as they are drawn, wrapped and measured: closed, outward, of even fineness.
// Packages come with bones of holes, of triangles that face either way, of edges from half a
// millimetre to five centimetres.
#pragma once

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// The same bone with its triangles turned alike and its holes closed. Where edges are much shorter
// than a fiftieth of its size (1 to 4 mm), it is simplified (simplify.h).
// Precondition: `mesh` has a triangle; F indexes V; V is finite, m.
TriMesh closed_bone(const TriMesh& mesh);

// A bone whose edges are much longer than that refined once by modified butterfly subdivision
// (Zorin et al. 1996, 10.1145/237170.237254), which keeps its vertices, first and in their order,
// and rounds what lies between; another as it is. Precondition: a closed manifold.
TriMesh rounded_bone(const TriMesh& mesh);

}  // namespace ecorche::inline v1
