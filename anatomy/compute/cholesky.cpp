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

template <int kSize>
ColumnVector<kSize> solve_llt_first(int count, const SquareMatrix<kSize>& A,
                                    const ColumnVector<kSize>& b) {
  SquareMatrix<kSize> L;
  ColumnVector<kSize> x, scale;  // one over the factor's diagonal
  for (int i = 0; i < count; ++i) {
    double corner = A(i, i), right = b[i];
    for (int j = 0; j < i; ++j) {
      double sum = A(i, j);
      for (int k = 0; k < j; ++k) sum -= L(i, k) * L(j, k);
      L(i, j) = sum * scale[j];
      corner -= L(i, j) * L(i, j);
      right -= L(i, j) * x[j];
    }
    scale[i] = 1 / std::sqrt(corner);
    x[i] = right * scale[i];
  }
  for (int i = count - 1; i >= 0; --i) {
    for (int k = i + 1; k < count; ++k) x[i] -= L(k, i) * x[k];
    x[i] *= scale[i];
  }
  return x;
}
template ColumnVector<12> solve_llt_first<12>(int, const SquareMatrix<12>&,
                                              const ColumnVector<12>&);

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
