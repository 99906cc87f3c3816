#include "morph/shapes/rbf_network.h"

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "anatomy/compute/cholesky.h"

namespace ecorche::inline v1 {
namespace {

struct Solved {
  Eigen::VectorXd weights, left_out;
  double error = 0;  // root mean square of the leave-one-out residuals
};

Solved solve(const Eigen::MatrixXd& A, const Eigen::VectorXd& y, double ridge) {
  Eigen::MatrixXd N = A.transpose() * A;
  N.diagonal().array() += ridge * double(A.rows());
  const CholeskyFactor factor(N);
  Solved out;
  out.weights = factor.solve(A.transpose() * y);
  const Eigen::MatrixXd H = factor.solve_columns(A.transpose());
  const Eigen::VectorXd fitted = A * out.weights;
  out.left_out.resize(y.size());
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    const double h = A.row(i).dot(H.col(i));
    out.left_out[i] = y[i] - (y[i] - fitted[i]) / std::max(1e-6, 1 - h);
  }
  out.error = std::sqrt((out.left_out - y).squaredNorm() / double(y.size()));
  return out;
}

Eigen::VectorXd gaussian(const Eigen::MatrixXd& X, const Eigen::VectorXd& centre, double width) {
  return (-width * (X.rowwise() - centre.transpose()).rowwise().squaredNorm().array())
      .exp()
      .matrix();
}

}  // namespace

RadialNetwork learn_network(const Eigen::MatrixXd& X, const Eigen::VectorXd& y,
                            const RadialOptions& options, Eigen::VectorXd* left_out) {
  const Eigen::Index n = X.rows(), d = X.cols();
  if (n < d + 3 || y.size() != n) throw std::invalid_argument("learn_network: too few examples");
  Eigen::MatrixXd A(n, d + 1);
  A << Eigen::VectorXd::Ones(n), X;
  Solved best = solve(A, y, options.ridge);
  RadialNetwork out;
  std::mt19937 random(options.seed);
  std::normal_distribution<double> normal;
  std::vector<bool> taken(n, false);
  std::vector<Eigen::Index> centres;
  std::vector<double> widths;
  for (int k = 0; k < options.gaussians; ++k) {
    Eigen::Index worst = -1;
    for (Eigen::Index i = 0; i < n; ++i)
      if (!taken[i] && (worst < 0 || std::abs(best.left_out[i] - y[i]) >
                                         std::abs(best.left_out[worst] - y[worst])))
        worst = i;
    if (worst < 0) break;
    taken[worst] = true;
    Eigen::MatrixXd longer(n, A.cols() + 1), kept;
    longer.leftCols(A.cols()) = A;
    Solved chosen = best;
    double width = 0;
    for (int attempt = 0; attempt < options.tries; ++attempt) {
      const double beta = 0.5 * std::abs(normal(random)) / double(d);
      longer.rightCols(1) = gaussian(X, X.row(worst), beta);
      const Solved now = solve(longer, y, options.ridge);
      if (now.error < chosen.error) chosen = now, width = beta, kept = longer;
    }
    if (width == 0) continue;  // no width helps at this example; the next worst may
    A = kept;
    best = chosen;
    centres.push_back(worst);
    widths.push_back(width);
  }
  out.weights = best.weights;
  out.centres.resize(centres.size(), d);
  out.widths.resize(out.centres.rows());
  for (std::size_t k = 0; k < centres.size(); ++k) {
    out.centres.row(k) = X.row(centres[k]);
    out.widths[k] = widths[k];
  }
  if (left_out != nullptr) *left_out = best.left_out;
  return out;
}

double evaluate(const RadialNetwork& network, const Eigen::VectorXd& x) {
  double sum = network.weights[0] + network.weights.segment(1, x.size()).dot(x);
  for (Eigen::Index k = 0; k < network.widths.size(); ++k)
    sum += network.weights[1 + x.size() + k] *
           std::exp(-network.widths[k] * (network.centres.row(k).transpose() - x).squaredNorm());
  return sum;
}

}  // namespace ecorche::inline v1
