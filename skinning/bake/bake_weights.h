// Weights of one vertex on the simplex. Private to the room.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace ecorche::inline v1 {

// min w' G w + ridge |w - start|^2 with w >= 0, sum w = 1, and at most `most` of them not zero.
// G: #joints x #joints, positive semidefinite: Gram matrix of the errors that each joint alone
// would leave.
Eigen::VectorXd simplex_weights(const Eigen::MatrixXd& G, const Eigen::VectorXd& start,
                                double ridge, int most);

}  // namespace ecorche::inline v1
