// Eigenvectors and singular vectors of dense matrices.
//
// The .cpp alone instantiates Eigen's decompositions, which take seconds to compile. A size that is
// known in advance is a template argument: Eigen's code for it differs, and so do the last bits.
#pragma once

#include <Eigen/Core>

#include "anatomy/compute/matrix_sizes.h"

namespace ecorche::inline v1 {

template <int kSize>
struct SymmetricEigen {
  ColumnVector<kSize> values;   // ascending
  SquareMatrix<kSize> vectors;  // columns of unit length, in the order of the values
};
// Of a symmetric matrix; only its lower half is read. kSize: 2, 3 or Eigen::Dynamic.
template <int kSize>
SymmetricEigen<kSize> symmetric_eigen(const SquareMatrix<kSize>& A);
Eigen::Vector2d symmetric_eigenvalues(const Eigen::Matrix2d& A);  // ascending

struct GeneralEigen3 {
  Eigen::Vector3cd values;   // in no order
  Eigen::Matrix3cd vectors;  // columns of unit length
  bool converged = false;    // else neither is set
};
GeneralEigen3 general_eigen(const Eigen::Matrix3d& A);

// A = U diag(S) V'. U and V are orthogonal, also for a singular A; S falls.
struct Svd3 {
  Eigen::Matrix3d U;
  Eigen::Vector3d S;
  Eigen::Matrix3d V;
};
Svd3 svd(const Eigen::Matrix3d& A);

// The proper rotation R (determinant 1) with the largest trace of R' A: of a matrix of moments
// sum y x', the least-squares rotation from x to y (Kabsch 1976, 10.1107/S0567739476001873).
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& A);

}  // namespace ecorche::inline v1
