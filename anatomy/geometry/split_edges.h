// Refinements whose long edges are halved, so that a skin holds short waves wherever it has them.
#pragma once

#include <functional>
#include <vector>

#include "anatomy/geometry/subdivide.h"
#include "anatomy/types.h"

namespace ecorche::inline v1 {

using TextureCorner = Eigen::RowVector2f;  // right and up, (0, 0) at the lower left; 3 a triangle

// Halves the edges that are longer than `longest` says for their middles, and again, `rounds` times
// at most. A middle lies by the butterfly scheme (Dyn, Levin and Gregory 1990), on the straight
// edge along a boundary; vertices that were there stay, with their numbers. `fine`: the positions
// of the refinement's vertices, by which edges are measured, m; the new ones are added to them.
// `corners`: places of its triangles' corners on a texture, which are halved, too; or none.
Refinement split_long_edges(const Refinement& refinement, Points& fine,
                            const std::function<double(const Vec3&)>& longest,
                            std::vector<TextureCorner>& corners, int rounds = 3);

}  // namespace ecorche::inline v1
