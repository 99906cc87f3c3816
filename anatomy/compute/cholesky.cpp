#include "anatomy/compute/cholesky.h"

#include <Eigen/Cholesky>

#include <cmath>

namespace ecorche::inline v1 {

template <int kSize>
ColumnVector<kSize> solve_ldlt(const SquareMatrix<kSize>& A, const ColumnVector<kSize>& b) {
  return A.ldlt().solve(b);
}
template ColumnVector<3> solve_ldlt<3>(const SquareMatrix<3>&, const ColumnVector<3>&);
template ColumnVector<16> solve_ldlt<16>(const SquareMatrix<16>&, const ColumnVector<16>&);
template Eigen::VectorXd solve_ldlt<Eigen::Dynamic>(const Eigen::MatrixXd&, const Eigen::VectorXd&);

Eigen::MatrixXd solve_ldlt_columns(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  return A.ldlt().solve(B);
}

RowMatrix3 solve_ldlt_columns3(const Eigen::Matrix3d& A, const RowMatrix3& B) {
  return A.ldlt().solve(B);
}

// Columns one after the other; Eigen's code for small sizes goes through the calls of large ones.
template <int kSize>
ColumnVector<kSize> solve_llt_small(SquareMatrix<kSize> A, ColumnVector<kSize> b) {
  for (int k = 0; k < kSize; ++k) {
    const double pivot = 1 / std::sqrt(A(k, k));
    for (int i = k; i < kSize; ++i) A(i, k) *= pivot;
    b[k] *= pivot;
    for (int i = k + 1; i < kSize; ++i) b[i] -= A(i, k) * b[k];
    for (int j = k + 1; j < kSize; ++j)
      for (int i = j; i < kSize; ++i) A(i, j) -= A(i, k) * A(j, k);
    A(k, k) = pivot;
  }
  for (int k = kSize - 1; k >= 0; --k) {
    for (int i = k + 1; i < kSize; ++i) b[k] -= A(i, k) * b[i];
    b[k] *= A(k, k);
  }
  return b;
}
template ColumnVector<12> solve_llt_small<12>(SquareMatrix<12>, ColumnVector<12>);

Eigen::VectorXd solve_llt(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.llt().solve(b);
}

Eigen::VectorXd solve_llt_in_place(Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(A);
  return factor.solve(b);
}

CholeskyFactor::CholeskyFactor(const Eigen::MatrixXd& A) : lower_(A.llt().matrixLLT()) {}

Eigen::VectorXd CholeskyFactor::solve(const Eigen::VectorXd& b) const {
  Eigen::VectorXd x = b;
  lower_.triangularView<Eigen::Lower>().solveInPlace(x);
  lower_.adjoint().triangularView<Eigen::Upper>().solveInPlace(x);
  return x;
}

Eigen::MatrixXd CholeskyFactor::solve_columns(const Eigen::MatrixXd& B) const {
  Eigen::MatrixXd X = B;
  lower_.triangularView<Eigen::Lower>().solveInPlace(X);
  lower_.adjoint().triangularView<Eigen::Upper>().solveInPlace(X);
  return X;
}

double CholeskyFactor::log_determinant() const { return 2 * lower_.diagonal().array().log().sum(); }

}  // namespace ecorche::inline v1
