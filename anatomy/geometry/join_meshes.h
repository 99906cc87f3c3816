// Several meshes as one.
#pragma once

#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Vertices and triangles one part after the other, nothing welded.
TriMesh join_meshes(const std::vector<const TriMesh*>& parts);

}  // namespace ecorche::inline v1
