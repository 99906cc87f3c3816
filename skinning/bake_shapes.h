// The shapes that take up what influences leave over. Private to the room.
#pragma once

#include <Eigen/Core>

namespace ecorche {

struct Shapes {
  Eigen::MatrixXd offsets;    // 3 #V x #shapes
  Eigen::MatrixXd projector;  // the same size; its transpose times a leftover gives the curves
};

// At most `most` directions that span leftovers (3 #V x #samples) best. Principal components give the least mean error; vertices that
// they leave far off are then given more weight, round by round, and the round with the least maximum is kept.
Shapes even_shapes(const Eigen::MatrixXd& leftovers, int most);

}  // namespace ecorche
