#include "anatomy/geometry/bezier.h"

#include <algorithm>
#include <cmath>

#include "anatomy/compute/cholesky.h"

namespace ecorche::inline v1 {
namespace {

constexpr int kPieces = 400;  // of a curve, for lengths

// Bernstein polynomials of degree n at t.
Eigen::VectorXd bernstein(int n, double t) {
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n + 1);
  b[0] = 1;
  for (int degree = 1; degree <= n; ++degree) {
    for (int k = degree; k >= 0; --k)
      b[k] = (1 - t) * (k < degree ? b[k] : 0) + (k > 0 ? t * b[k - 1] : 0);
  }
  return b;
}

Vec3 combine(std::span<const Vec3> points, const Eigen::VectorXd& weights) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < points.size(); ++k) sum += weights[k] * points[k];
  return sum;
}

std::vector<double> chord_parameters(std::span<const Vec3> points) {
  std::vector<double> t(points.size(), 0.0);
  for (std::size_t k = 1; k < points.size(); ++k)
    t[k] = t[k - 1] + (points[k] - points[k - 1]).norm();
  for (double& v : t) v /= std::max(t.back(), 1e-300);
  t.back() = 1;
  return t;
}

// Inner controls for given parameters. A trace of stiffness keeps controls apart that the points do
// not determine.
Bezier solve_controls(std::span<const Vec3> points, std::span<const double> t, int inner) {
  const int degree = inner + 1;
  const Eigen::Index n = points.size();
  Eigen::MatrixXd A(n, inner), rhs(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::VectorXd b = bernstein(degree, t[i]);
    A.row(i) = b.segment(1, inner).transpose();
    rhs.row(i) = (points[i] - b[0] * points.front() - b[degree] * points.back()).transpose();
  }
  Eigen::MatrixXd bend = Eigen::MatrixXd::Zero(inner, inner),
                  bend_rhs = Eigen::MatrixXd::Zero(inner, 3);  // second differences of all controls
  for (int k = 0; k < inner; ++k) {
    bend(k, k) = -2;
    if (k > 0)
      bend(k, k - 1) = 1;
    else
      bend_rhs.row(k) -= points.front().transpose();
    if (k + 1 < inner)
      bend(k, k + 1) = 1;
    else
      bend_rhs.row(k) -= points.back().transpose();
  }
  const double stiffness = 3e-4 * double(n);
  const Eigen::MatrixXd normal = A.transpose() * A + stiffness * bend.transpose() * bend;
  const Eigen::MatrixXd X =
      solve_ldlt_columns(normal, A.transpose() * rhs + stiffness * bend.transpose() * bend_rhs);
  Bezier curve{{points.front()}};
  for (int k = 0; k < inner; ++k) curve.controls.push_back(X.row(k).transpose());
  curve.controls.push_back(points.back());
  return curve;
}

// One Newton-like step of each inner parameter towards the foot of its point, kept in order.
void reparametrise(const Bezier& curve, std::span<const Vec3> points, std::vector<double>& t) {
  for (std::size_t k = 1; k + 1 < t.size(); ++k) {
    const double h = 1e-4, lower = std::max(0.0, t[k] - h), upper = std::min(1.0, t[k] + h);
    const Vec3 speed = (bezier_point(curve, upper) - bezier_point(curve, lower)) / (upper - lower);
    if (speed.squaredNorm() > 0)
      t[k] += (points[k] - bezier_point(curve, t[k])).dot(speed) / speed.squaredNorm();
    t[k] = std::clamp(t[k], t[k - 1], 1.0);
  }
}

}  // namespace

Vec3 bezier_point(const Bezier& curve, double t) {
  return combine(curve.controls, bernstein(int(curve.controls.size()) - 1, t));
}

Vec3 bezier_tangent(const Bezier& curve, double t) {
  std::vector<Vec3> differences;
  for (std::size_t k = 1; k < curve.controls.size(); ++k)
    differences.push_back(curve.controls[k] - curve.controls[k - 1]);
  const Vec3 derivative = combine(differences, bernstein(int(differences.size()) - 1, t));
  const Vec3 chord = curve.controls.back() - curve.controls.front();
  return derivative.norm() > 1e-9 * chord.norm() ? derivative.normalized() : chord.normalized();
}

Bezier fit_bezier(std::span<const Vec3> points, int inner) {
  inner = std::max(inner, 0);
  if (inner == 0 || points.size() < 3) return {{points.front(), points.back()}};
  std::vector<double> t = chord_parameters(points);
  Bezier curve = solve_controls(points, t, inner);
  for (int round = 0; round < 4; ++round) {
    reparametrise(curve, points, t);
    curve = solve_controls(points, t, inner);
  }
  return curve;
}

std::vector<double> bezier_parameters(const Bezier& curve, std::span<const double> fractions) {
  std::vector<double> lengths{0};
  Vec3 last = bezier_point(curve, 0);
  for (int k = 1; k <= kPieces; ++k) {
    const Vec3 next = bezier_point(curve, double(k) / kPieces);
    lengths.push_back(lengths.back() + (next - last).norm());
    last = next;
  }
  std::vector<double> out;
  for (double fraction : fractions) {
    const double wanted = std::clamp(fraction, 0.0, 1.0) * lengths.back();
    const auto above = std::upper_bound(lengths.begin(), lengths.end(), wanted);
    const auto k = std::clamp<std::ptrdiff_t>(above - lengths.begin(), 1, kPieces);
    const double begin = lengths[k - 1], piece = lengths[k] - begin;
    out.push_back((double(k - 1) + (piece > 0 ? (wanted - begin) / piece : 0)) / kPieces);
  }
  return out;
}

double bezier_length(const Bezier& curve) {
  double sum = 0;
  for (int k = 0; k < kPieces; ++k) {
    sum += (bezier_point(curve, double(k + 1) / kPieces) - bezier_point(curve, double(k) / kPieces))
               .norm();
  }
  return sum;
}

}  // namespace ecorche::inline v1
