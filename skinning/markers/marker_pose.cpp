#include "skinning/markers/marker_pose.h"

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

#include "anatomy/compute/cholesky.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kLimitSoftness = 1 * kDegree;  // beyond a limit, for the cost of one spread
constexpr double kSmallStep = 1e-5;             // rad, m: nothing more is gained

// A marker's derivatives by those coordinates that move it.
struct MarkerRow {
  Eigen::Matrix3Xd by_coordinate;
  std::vector<int> moved;
  Eigen::Matrix<double, 3, int(kFigureSizes.size())> by_size;
};

void find_moved(MarkerRow& row) {
  row.moved.clear();
  for (int c = 0; c < int(row.by_coordinate.cols()); ++c)
    if (!row.by_coordinate.col(c).isZero(0)) row.moved.push_back(c);
}

void add_marker(const MarkerRow& row, const Vec3& off, double weight, PoseSystem& out) {
  for (std::size_t a = 0; a < row.moved.size(); ++a) {
    const Vec3 J = weight * row.by_coordinate.col(row.moved[a]);
    out.g[row.moved[a]] += J.dot(off);
    for (std::size_t b = 0; b <= a; ++b)
      out.H(row.moved[a], row.moved[b]) += J.dot(row.by_coordinate.col(row.moved[b]));
  }
}

void add_shared_marker(const MarkerRow& row, const Mat3& R, const Vec3& off, double weight,
                       std::size_t marker, PoseSystem& out) {
  constexpr Eigen::Index kSizes = Eigen::Index(kFigureSizes.size());
  const Eigen::Index at = kSizes + 3 * Eigen::Index(marker);
  for (const int c : row.moved) {
    const Eigen::RowVector3d J = weight * row.by_coordinate.col(c).transpose();
    out.mixed.row(c).head<kSizes>() += J * row.by_size;
    out.mixed.row(c).segment<3>(at) += J * R;
  }
  out.shared.topLeftCorner<kSizes, kSizes>() += weight * row.by_size.transpose() * row.by_size;
  out.shared.block<3, kSizes>(at, 0) += weight * R.transpose() * row.by_size;
  out.shared.block<3, 3>(at, at) += weight * Mat3::Identity();
  out.shared_g.head<kSizes>() += weight * row.by_size.transpose() * off;
  out.shared_g.segment<3>(at) += weight * R.transpose() * off;
}

void add_square(int coordinate, double off, double precision, PoseSystem& out) {
  out.H(coordinate, coordinate) += precision;
  out.g[coordinate] += precision * off;
  out.cost += 0.5 * precision * off * off;
}

// What is known of a pose before anything is seen.
void add_usual(const MarkerFigure& figure, const FigurePose& upright, const FigurePose& at,
               PoseSystem& out) {
  Eigen::VectorXd off;
  figure_difference(figure, upright, at, off);
  for (const FigureTurn& turn : figure.turns) {
    if (turn.free) {
      if (turn.parent < 0) continue;
      for (int k = 0; k < 3; ++k)
        add_square(turn.first + k, off[turn.first + k], 1 / std::pow(turn.spread[k], 2), out);
      continue;
    }
    for (std::size_t i = 0; i < turn.components.size(); ++i) {
      const int k = turn.components[i], c = turn.first + int(i);
      add_square(c, off[c], 1 / std::pow(turn.spread[k], 2), out);
      const double v = at.shared[turn.slot][k],
                   beyond = v > turn.high[k] ? v - turn.high[k] : std::min(0.0, v - turn.low[k]);
      if (beyond != 0) add_square(c, beyond, 1 / std::pow(kLimitSoftness, 2), out);
    }
  }
}

}  // namespace

void assemble_pose(const MarkerModel& model, const Points& seen, const PoseOptions& options,
                   const FigurePose* before, const FigurePose& at, bool with_shared,
                   PoseSystem& out) {
  const MarkerFigure& figure = model.figure;
  const Eigen::Index n = figure.coordinates,
                     shared = with_shared ? Eigen::Index(kFigureSizes.size()) +
                                                3 * Eigen::Index(model.markers.size())
                                          : 0;
  out.H.setZero(n, n);
  out.g.setZero(n);
  out.mixed.setZero(n, shared);
  out.shared.setZero(shared, shared);
  out.shared_g.setZero(shared);
  out.cost = 0;
  Pose pose;
  std::vector<Transform> X;
  figure_kinematics(figure, at, pose, X);
  MarkerRow row;
  for (std::size_t m = 0; m < model.markers.size(); ++m) {
    if (!seen.row(Eigen::Index(m)).allFinite()) continue;
    const BodyMarker& marker = model.markers[m];
    const Vec3 off = figure_point(figure, X, marker.joint, marker.local, model.offsets[m]) -
                     seen.row(Eigen::Index(m)).transpose();
    const double spread = std::hypot(options.noise, options.loose ? marker.spread : 0),
                 outlier = std::hypot(options.outlier, options.loose ? 2 * marker.spread : 0),
                 far = off.squaredNorm() / (outlier * outlier);
    const double weight = 1 / (spread * spread * (1 + far));
    out.cost += 0.5 * std::pow(outlier / spread, 2) * std::log1p(far);
    row.by_coordinate.setZero(3, n);
    point_derivatives(figure, at, X, marker.joint, marker.local, model.offsets[m],
                      row.by_coordinate, with_shared ? &row.by_size : nullptr);
    find_moved(row);
    add_marker(row, off, weight, out);
    if (with_shared) add_shared_marker(row, X[marker.joint].linear(), off, weight, m, out);
  }
  add_usual(figure, attention(figure), at, out);
  if (!before || !(options.hold > 0)) return;
  Eigen::VectorXd off;
  figure_difference(figure, *before, at, off);
  for (int c = 6; c < figure.coordinates; ++c) add_square(c, off[c], options.hold, out);
}

double solve_pose(const MarkerModel& model, const Points& seen, const PoseOptions& options,
                  const FigurePose* before, FigurePose& at) {
  PoseSystem now, next;
  assemble_pose(model, seen, options, before, at, false, now);
  double damping = 1e-6;
  for (int round = 0; round < options.rounds; ++round) {
    Eigen::MatrixXd H = now.H;
    H.diagonal() *= 1 + damping;
    H.diagonal().array() += 1e-3;
    Eigen::VectorXd step = -solve_llt_in_place(H, now.g);
    const double largest = step.tail(step.size() - 3).cwiseAbs().maxCoeff();
    if (largest > 0.6) step *= 0.6 / largest;
    FigurePose there = at;
    move_figure(model.figure, step, there);
    assemble_pose(model, seen, options, before, there, false, next);
    if (next.cost > now.cost) {
      damping = std::max(1e-4, damping * 10);
      if (damping > 1e3) break;
      continue;
    }
    const double gained = now.cost - next.cost;
    at = std::move(there);
    std::swap(now, next);
    damping = std::max(1e-7, damping * 0.1);
    if (step.cwiseAbs().maxCoeff() < kSmallStep || gained < 1e-7 * now.cost) break;
  }
  return now.cost;
}

FigurePose place_upright(const MarkerModel& model, const Points& seen) {
  FigurePose out = attention(model.figure);
  Pose pose;
  std::vector<Transform> X;
  figure_kinematics(model.figure, out, pose, X);
  std::vector<Vec3> ours, theirs;
  std::vector<double> weights;
  Vec3 our_middle = Vec3::Zero(), their_middle = Vec3::Zero();
  double sum = 0;
  for (std::size_t m = 0; m < model.markers.size(); ++m) {
    if (!seen.row(Eigen::Index(m)).allFinite()) continue;
    const BodyMarker& marker = model.markers[m];
    ours.push_back(figure_point(model.figure, X, marker.joint, marker.local, model.offsets[m]));
    theirs.push_back(seen.row(Eigen::Index(m)).transpose());
    weights.push_back(1 / std::pow(std::hypot(0.03, marker.spread), 2));
    our_middle += weights.back() * ours.back();
    their_middle += weights.back() * theirs.back();
    sum += weights.back();
  }
  if (ours.size() < 3) return out;
  our_middle /= sum, their_middle /= sum;
  Mat3 M = Mat3::Zero();
  for (std::size_t i = 0; i < ours.size(); ++i)
    M += weights[i] * (theirs[i] - their_middle) * (ours[i] - our_middle).transpose();
  const Eigen::JacobiSVD<Mat3> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 flip = Mat3::Identity();
  flip(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Mat3 R = svd.matrixU() * flip * svd.matrixV().transpose();
  out.free[0] = Quat(R) * out.free[0];
  out.root = their_middle + R * (out.root - our_middle);
  return out;
}

double pose_residual(const MarkerModel& model, const Points& seen, const FigurePose& at) {
  Pose pose;
  std::vector<Transform> X;
  figure_kinematics(model.figure, at, pose, X);
  double sum = 0;
  int count = 0;
  for (std::size_t m = 0; m < model.markers.size(); ++m) {
    if (!seen.row(Eigen::Index(m)).allFinite()) continue;
    const BodyMarker& marker = model.markers[m];
    sum += (figure_point(model.figure, X, marker.joint, marker.local, model.offsets[m]) -
            seen.row(Eigen::Index(m)).transpose())
               .squaredNorm();
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

}  // namespace ecorche::inline v1
