#include "skinning/bake_shapes.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace ecorche {
namespace {

// Principal directions of the samples' leftovers, rows weighted.
Shapes principal_shapes(const Eigen::MatrixXd& leftovers, const Eigen::VectorXd& row_weights, int most) {
  const Eigen::MatrixXd scaled = row_weights.asDiagonal() * leftovers;
  const Eigen::MatrixXd gram = scaled.transpose() * scaled;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram);
  const Eigen::Index n = gram.rows();
  const double smallest = 1e-10 * std::max(gram.trace(), 1e-18);
  Eigen::Index count = 0;
  while (count < std::min<Eigen::Index>(most, n) && solver.eigenvalues()[n - 1 - count] > smallest) ++count;
  Eigen::MatrixXd basis(leftovers.rows(), count);
  for (Eigen::Index m = 0; m < count; ++m)
    basis.col(m) = scaled * solver.eigenvectors().col(n - 1 - m) / std::sqrt(solver.eigenvalues()[n - 1 - m]);
  return {row_weights.cwiseInverse().asDiagonal() * basis, row_weights.asDiagonal() * basis};
}

}  // namespace

Shapes even_shapes(const Eigen::MatrixXd& leftovers, int most) {
  constexpr int kRounds = 5;
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(leftovers.rows());
  Shapes best;
  double least = -1;
  for (int round = 0; round < kRounds; ++round) {
    Shapes shapes = principal_shapes(leftovers, weights, most);
    const Eigen::MatrixXd left = leftovers - shapes.offsets * (shapes.projector.transpose() * leftovers);
    Eigen::VectorXd worst(leftovers.rows() / 3);
    for (Eigen::Index i = 0; i < worst.size(); ++i) worst[i] = left.middleRows<3>(3 * i).colwise().norm().maxCoeff();
    if (least < 0 || worst.maxCoeff() < least) {
      least = worst.maxCoeff();
      best = std::move(shapes);
    }
    if (worst.maxCoeff() <= 0) break;
    for (Eigen::Index i = 0; i < worst.size(); ++i)
      weights.segment<3>(3 * i) *= std::sqrt(std::clamp(worst[i] / (0.25 * worst.maxCoeff()), 0.25, 4.0));
  }
  return best;
}

}  // namespace ecorche
