// The mirror image of a mesh.
#pragma once

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Across the plane x = `mid_plane`, m; its outside stays outside, vertices and faces keep their
// order.
TriMesh mirror_mesh(TriMesh mesh, double mid_plane);

}  // namespace ecorche::inline v1
