#include "anatomy/compute/eigenvectors.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace ecorche::inline v1 {

template <int kSize>
SymmetricEigen<kSize> symmetric_eigen(const SquareMatrix<kSize>& A) {
  const Eigen::SelfAdjointEigenSolver<SquareMatrix<kSize>> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}
template SymmetricEigen<2> symmetric_eigen<2>(const SquareMatrix<2>&);
template SymmetricEigen<3> symmetric_eigen<3>(const SquareMatrix<3>&);
template SymmetricEigen<Eigen::Dynamic> symmetric_eigen<Eigen::Dynamic>(const Eigen::MatrixXd&);

Eigen::Vector2d symmetric_eigenvalues(const Eigen::Matrix2d& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

GeneralEigen3 general_eigen(const Eigen::Matrix3d& A) {
  const Eigen::EigenSolver<Eigen::Matrix3d> solver(A);
  if (solver.info() != Eigen::Success) return {};
  return {solver.eigenvalues(), solver.eigenvectors(), true};
}

Svd3 svd(const Eigen::Matrix3d& A) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> solver(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {solver.matrixU(), solver.singularValues(), solver.matrixV()};
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& A) {
  const Svd3 parts = svd(A);
  Eigen::Vector3d sign(1, 1, 1);
  if ((parts.U * parts.V.transpose()).determinant() < 0) sign[2] = -1;
  return parts.U * sign.asDiagonal() * parts.V.transpose();
}

}  // namespace ecorche::inline v1
