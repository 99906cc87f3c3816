#include "anatomy/geometry/ellipse_fit.h"

#include <algorithm>
#include <cmath>

#include "anatomy/compute/cholesky.h"
#include "anatomy/compute/eigenvectors.h"

namespace ecorche::inline v1 {
namespace {

using Conic = Eigen::Matrix<double, 6, 1>;  // a x^2 + b x y + c y^2 + d x + e y + f = 0

std::optional<Ellipse2> ellipse_of(const Conic& q) {
  Eigen::Matrix2d A;
  A << q[0], q[1] / 2, q[1] / 2, q[2];
  if (!(A.determinant() > 0)) return std::nullopt;
  const Vec2 center = -0.5 * A.inverse() * Vec2(q[3], q[4]);
  const double level = center.dot(A * center) - q[5];  // (x - center)' A (x - center) = level
  const SymmetricEigen<2> axes = symmetric_eigen(A);
  const Vec2 squares = level * axes.values.cwiseInverse();
  if (!(squares.minCoeff() > 0) || !squares.allFinite()) return std::nullopt;
  Eigen::Index longer = 0;
  squares.maxCoeff(&longer);
  Ellipse2 out;
  out.center = center;
  out.radii = Vec2(std::sqrt(squares[longer]), std::sqrt(squares[1 - longer]));
  out.angle = std::atan2(axes.vectors(1, longer), axes.vectors(0, longer));
  return out;
}

}  // namespace

std::optional<Ellipse2> fit_ellipse(std::span<const Vec2> points) {
  if (points.size() < 5) return std::nullopt;
  const Eigen::Index n = points.size();
  Vec2 middle = Vec2::Zero();
  for (const Vec2& p : points) middle += p / double(n);
  double size = 0;
  for (const Vec2& p : points) size = std::max(size, (p - middle).norm());
  if (!(size > 1e-12 * (1 + middle.norm()))) return std::nullopt;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Vec2& p : points) spread += (p - middle) * (p - middle).transpose();
  const Vec2 spreads = symmetric_eigenvalues(spread);
  if (spreads[0] < 1e-10 * spreads[1]) return std::nullopt;  // a line

  // Quadratic and linear terms apart, of points brought to unit size: that is what keeps the normal
  // equations well behaved.
  Eigen::Matrix<double, Eigen::Dynamic, 3> quadratic(n, 3), linear(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec2 p = (points[i] - middle) / size;
    quadratic.row(i) << p.x() * p.x(), p.x() * p.y(), p.y() * p.y();
    linear.row(i) << p.x(), p.y(), 1;
  }
  const Mat3 S1 = quadratic.transpose() * quadratic, S2 = quadratic.transpose() * linear,
             S3 = linear.transpose() * linear;
  const Mat3 T = -solve_ldlt_columns3(S3, S2.transpose());
  const Mat3 M = S1 + S2 * T;
  Mat3 reduced;  // C^-1 M with the constraint 4 a c - b^2 = 1
  reduced.row(0) = M.row(2) / 2;
  reduced.row(1) = -M.row(1);
  reduced.row(2) = M.row(0) / 2;
  const GeneralEigen3 solutions = general_eigen(reduced);
  if (!solutions.converged) return std::nullopt;
  std::optional<Ellipse2> best;
  double best_value = 0;
  for (int k = 0; k < 3; ++k) {
    const auto vector = solutions.vectors.col(k).eval();
    const Vec3 a(vector[0].real(), vector[1].real(), vector[2].real());
    if (!(4 * a[0] * a[2] - a[1] * a[1] > 0)) continue;
    const double value = std::abs(solutions.values[k].real());
    Conic conic;
    conic.head<3>() = a;
    conic.tail<3>() = T * a;
    const auto ellipse = ellipse_of(conic);
    if (ellipse && (!best || value < best_value)) best = ellipse, best_value = value;
  }
  if (best) {
    best->center = middle + size * best->center;
    best->radii *= size;
  }
  return best;
}

}  // namespace ecorche::inline v1
