// The body package's skin at the finer resolution.
#pragma once

#include "anatomy/base_mesh/body_package.h"
#include "anatomy/geometry/subdivide.h"

namespace ecorche::inline v1 {

// The fine skin of the body package, 120,404 vertices, its vertices and triangles in spatial order
// of the undeformed shape.
Refinement refine_skin(const BodyPackage& package);

// The fine skin with the package's cavities removed and closed by fans; vertices follow the fine
// ones, as in capped_skin.
TriMesh capped_skin(const BodyPackage& package, const Refinement& refinement, const Points& fine);

}  // namespace ecorche::inline v1
