// Moments of joints shared out among muscles by the least effort.
#pragma once

#include <Eigen/Core>

namespace ecorche::inline v1 {

// min sum(cost a^2) / 2 + stiffness |A a - b|^2 / 2 for a in [0, 1], by Newton on the dual. A:
// #moments x #muscles, what each gives at full effort; cost: #muscles, above 0; empty: all 1. What
// the muscles cannot give is left to a reserve. `dual`: #moments, where to begin, left where it
// ended; null or another size: from nought.
Eigen::VectorXd distribute_moments(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                   double stiffness, const Eigen::VectorXd& cost = {},
                                   Eigen::VectorXd* dual = nullptr);

}  // namespace ecorche::inline v1
