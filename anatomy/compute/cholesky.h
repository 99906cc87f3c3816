// Linear systems with a symmetric matrix: A n x n, b n, B n x m; A x = b. A singular A is not
// reported.
//
// The .cpp alone instantiates Eigen's decompositions, which take seconds to compile. A size that is
// known in advance is a template argument: Eigen's code for it differs, and so do the last bits.
#pragma once

#include <Eigen/Core>

#include "anatomy/compute/matrix_sizes.h"

namespace ecorche::inline v1 {

// A symmetric and definite or semi-definite (robust Cholesky, L D L'). Components along which D is
// zero become zero. kSize: 3, 16 or Eigen::Dynamic.
template <int kSize>
ColumnVector<kSize> solve_ldlt(const SquareMatrix<kSize>& A, const ColumnVector<kSize>& b);
Eigen::MatrixXd solve_ldlt_columns(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
using RowMatrix3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
RowMatrix3 solve_ldlt_columns3(const Eigen::Matrix3d& A, const RowMatrix3& B);

// A symmetric and positive definite (Cholesky, L L'); only its lower half is read. The result is
// meaningless where A is not positive definite.
Eigen::VectorXd solve_llt(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
// The same of the first `count` unknowns alone, 0 .. kSize; the others of the result mean nothing.
// kSize: 12.
template <int kSize>
ColumnVector<kSize> solve_llt_first(int count, const SquareMatrix<kSize>& A,
                                    const ColumnVector<kSize>& b);
// The same; the factor replaces the lower half of A.
Eigen::VectorXd solve_llt_in_place(Eigen::MatrixXd& A, const Eigen::VectorXd& b);

// The Cholesky factor of such a matrix, for several right-hand sides.
class CholeskyFactor {
 public:
  explicit CholeskyFactor(const Eigen::MatrixXd& A);
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  Eigen::MatrixXd solve_columns(const Eigen::MatrixXd& B) const;
  double log_determinant() const;

 private:
  Eigen::MatrixXd lower_;
};

}  // namespace ecorche::inline v1
