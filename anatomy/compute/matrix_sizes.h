// Square matrices and columns of a size that may be known in advance.
#pragma once

#include <Eigen/Core>

namespace ecorche::inline v1 {

template <int kSize>
using SquareMatrix = Eigen::Matrix<double, kSize, kSize>;
template <int kSize>
using ColumnVector = Eigen::Matrix<double, kSize, 1>;

}  // namespace ecorche::inline v1
