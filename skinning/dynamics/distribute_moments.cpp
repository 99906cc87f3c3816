#include "skinning/dynamics/distribute_moments.h"

#include <cmath>

#include "anatomy/compute/cholesky.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kSteps = 60, kDoublings = 12, kBisections = 24;
constexpr double kClose = 1e-8;      // of the moments
constexpr double kCloseSlope = 0.1;  // of the slope at a step's beginning

// The dual, convex in x; its gradient is x / stiffness + A a(x) - b.
class Dual {
 public:
  Dual(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double stiffness,
       const Eigen::VectorXd& cost)
      : A_(A),
        b_(b),
        stiffness_(stiffness),
        cost_(cost.size() == A.cols() ? cost : Eigen::VectorXd::Ones(A.cols())) {}

  Eigen::VectorXd efforts(const Eigen::VectorXd& x) const {
    return (A_.transpose() * x).cwiseQuotient(cost_).cwiseMax(0.0).cwiseMin(1.0);
  }
  Eigen::VectorXd gradient(const Eigen::VectorXd& x) const {
    return x / stiffness_ + A_ * efforts(x) - b_;
  }
  Eigen::VectorXd newton_step(const Eigen::VectorXd& x, const Eigen::VectorXd& gradient) const {
    const Eigen::VectorXd s = A_.transpose() * x;
    Eigen::MatrixXd free(A_.rows(), A_.cols());
    Eigen::Index count = 0;
    for (Eigen::Index m = 0; m < A_.cols(); ++m)
      if (s[m] >= 0 && s[m] < cost_[m]) free.col(count++) = A_.col(m) / std::sqrt(cost_[m]);
    Eigen::MatrixXd H = Eigen::MatrixXd::Identity(b_.size(), b_.size()) / stiffness_;
    H.selfadjointView<Eigen::Lower>().rankUpdate(free.leftCols(count));
    return -solve_llt_in_place(H, gradient);
  }

  // How far along a direction the dual falls: its slope there rises piece by piece in straight
  // lines.
  double step_length(const Eigen::VectorXd& x, const Eigen::VectorXd& direction) const {
    const Eigen::ArrayXd s = (A_.transpose() * x).array() / cost_.array(),
                         change = (A_.transpose() * direction).array();
    const Eigen::ArrayXd rate = change / cost_.array();
    const double start = x.dot(direction) / stiffness_ - b_.dot(direction),
                 bend = direction.squaredNorm() / stiffness_;
    const auto slope = [&](double t) {
      return start + t * bend + ((s + t * rate).max(0.0).min(1.0) * change).sum();
    };
    const double first = slope(0);
    double low = 0, high = 1;
    for (int k = 0; k < kDoublings && slope(high) < 0; ++k) low = high, high *= 2;
    if (low == 0 && slope(high) <= -kCloseSlope * first) return high;
    for (int k = 0; k < kBisections; ++k) {
      const double middle = 0.5 * (low + high), at = slope(middle);
      if (std::abs(at) <= -kCloseSlope * first) return middle;
      (at < 0 ? low : high) = middle;
    }
    return low;
  }

 private:
  const Eigen::MatrixXd& A_;
  const Eigen::VectorXd& b_;
  double stiffness_;
  Eigen::VectorXd cost_;
};

}  // namespace

Eigen::VectorXd distribute_moments(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                   double stiffness, const Eigen::VectorXd& cost,
                                   Eigen::VectorXd* dual) {
  const Dual problem(A, b, stiffness, cost);
  Eigen::VectorXd x =
      dual && dual->size() == b.size() ? *dual : Eigen::VectorXd(Eigen::VectorXd::Zero(b.size()));
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::VectorXd gradient = problem.gradient(x);
    if (gradient.norm() <= kClose * (1 + b.norm())) break;
    const Eigen::VectorXd direction = problem.newton_step(x, gradient);
    x += problem.step_length(x, direction) * direction;
  }
  if (dual) *dual = x;
  return problem.efforts(x);
}

}  // namespace ecorche::inline v1
