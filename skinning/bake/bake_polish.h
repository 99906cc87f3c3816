// Refines the shapes for the vertices with the largest errors. Private to the room.
#pragma once

#include <vector>

#include "skinning/bake/bake_shapes.h"

namespace ecorche::inline v1 {

// Changes the offsets of vertices with a large error in any frame so that their largest errors fall
// (bake_cost.h), with the curves fixed. `curves`: #shapes x #frames.
void polish_shapes(const std::vector<FrameResidual>& frames, const Eigen::MatrixXd& curves,
                   Shapes& shapes);

}  // namespace ecorche::inline v1
