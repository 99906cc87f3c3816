// The skin as it would lie on the chest if there were no breasts.
//
// Breasts are gland and fat before the chest's wall; muscles lie under the wall, not in the breast.
// Skin of heavy women touches or crosses itself under them. What the package's targets of the
// breast move is cut out and bridged by the smoothest patch that goes on from its rim: the least
// squared Laplacian (thin plate), by the metric of the undeformed base mesh, so that folds of the
// skin do not matter.
#pragma once

#include "anatomy/base_mesh/body_package.h"

namespace ecorche::inline v1 {

// The closed skin (capped_skin) of a body; of women with the breasts bridged. `V`: at least #skin
// rows. Same triangles and vertices as capped_skin. Nothing is bridged where the package has no
// targets.
TriMesh chest_wall_skin(const BodyPackage& package, Sex sex, const Points& V);

}  // namespace ecorche::inline v1
