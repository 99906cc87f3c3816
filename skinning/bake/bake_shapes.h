// The shapes that take up what influences leave over. Private to the room.
#pragma once

#include <vector>

#include "skinning/bake/bake_samples.h"

namespace ecorche {

// One frame: what a shape's offset of a vertex becomes in the world (3 x 3, by rows), and what is
// left over there.
struct Leftover {
  Rows9f blend;  // #V x 9
  Rows3f left;   // #V x 3, m
};

struct Shapes {
  Eigen::MatrixXf offsets;  // 3 #V x #shapes, rest pose; m where curves reach 1
};

// At most `most` shapes whose sums by a curve a frame come closest to `frames`: begun with
// principal components, then curves and shapes by turns, each least squares. Vertices that a frame
// leaves far off count more and more (Lawson 1961; the weights that go on growing are those of the
// largest errors), so that the largest error falls, not the mean alone. `start`: shapes to go on
// from; none: from the beginning.
Shapes fit_shapes(const std::vector<Leftover>& frames, int most, int rounds,
                  const Shapes& start = {});

}  // namespace ecorche
