// The weights of one vertex over the frames of joints. Private to the room.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace ecorche {

// min w' G w + ridge |w - start|^2 with w >= 0, sum w = 1, and at most `most` of them not zero.
// G: #joints x #joints, symmetric, not negative: products of where each joint alone would put the
// vertex, less where it should be.
Eigen::VectorXd simplex_weights(const Eigen::MatrixXd& G, const Eigen::VectorXd& start,
                                double ridge, int most);

}  // namespace ecorche
