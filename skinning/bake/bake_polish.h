// Shapes once more, for the vertices that stay farthest off. Private to the room.
#pragma once

#include <vector>

#include "skinning/bake/bake_shapes.h"

namespace ecorche {

// Moves the offsets of vertices that are far off in any frame so that their largest errors fall
// (bake_cost.h), the curves held. `curves`: #shapes x #frames.
void polish_shapes(const std::vector<Leftover>& frames, const Eigen::MatrixXd& curves,
                   Shapes& shapes);

}  // namespace ecorche
