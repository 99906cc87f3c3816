// Corrective shapes for the residual of the influences. Private to the room.
#pragma once

#include <vector>

#include "skinning/bake/bake_samples.h"

namespace ecorche::inline v1 {

// One frame: the map of a vertex's rest offset to the world (3 x 3, by rows), and the residual
// there.
struct FrameResidual {
  Rows9f blend;     // #V x 9
  Rows3f residual;  // #V x 3, m
};

struct Shapes {
  Eigen::MatrixXf offsets;  // 3 #V x #shapes, rest pose; m where curves reach 1
};

// At most `most` shapes whose weighted sums, with one weight a shape and frame, come closest to
// `frames`: principal components first, then curves and shapes in alternation, each by least
// squares. Vertices with a large error in a frame get rising weights (Lawson 1961), so that the
// largest error falls, not the mean alone. `start`: shapes to refine; none: from the beginning.
Shapes fit_shapes(const std::vector<FrameResidual>& frames, int most, int rounds,
                  const Shapes& start = {});

}  // namespace ecorche::inline v1
