// Origin and insertion of a muscle mesh that comes without them.
#pragma once

#include <utility>

#include "anatomy/authoring/resample_mesh.h"

namespace ecorche::inline v1 {

// The same where nobody has marked the ends: those points that lie furthest apart along the surface
// are tried, and the extremes along the mesh's two longest axes, each also moved out along the
// muscle's middle until no surface lies beyond. The first that comes back within 0.2 % of the
// mesh's size is kept, else the closest.
Resampled resample_muscle(const TriMesh& mesh, const ResampleOptions& options = {});

// The two points of a mesh that lie furthest apart along its surface: likely ends of a muscle that
// nobody has marked.
std::pair<Vec3, Vec3> furthest_ends(const TriMesh& mesh);

}  // namespace ecorche::inline v1
