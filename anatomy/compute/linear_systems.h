// Linear systems with any dense matrix, square or not: A x = b.
//
// The .cpp alone instantiates Eigen's decompositions, which take seconds to compile.
#pragma once

#include <Eigen/Core>

namespace ecorche::inline v1 {

// Any invertible A (LU with partial pivoting). A singular A gives values that are not finite.
Eigen::VectorXd solve_lu(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
Eigen::MatrixXd solve_lu_columns(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

// A m x n, m >= n: the least-squares solution (QR with column pivoting); components that a singular
// A leaves open become zero.
Eigen::VectorXd solve_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

// Any A, singular ones too: the shortest of the least-squares solutions (complete orthogonal
// decomposition).
Eigen::VectorXd solve_least_norm(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

}  // namespace ecorche::inline v1
