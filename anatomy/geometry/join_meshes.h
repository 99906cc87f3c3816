// Several meshes as one.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// Vertices and triangles one part after the other, nothing welded.
TriMesh join_meshes(const std::vector<const TriMesh*>& parts);

// All bones, at rest.
TriMesh joined_bones(const Anatomy& anatomy);

}  // namespace ecorche::inline v1
