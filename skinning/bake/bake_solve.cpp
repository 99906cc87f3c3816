#include "skinning/bake/bake_solve.h"

#include <algorithm>
#include <cmath>

#include "anatomy/compute/cholesky.h"
#include "anatomy/compute/linear_systems.h"
#include "skinning/bake/bake_cost.h"

namespace ecorche::inline v1 {
namespace {

using Eigen::Index;
using Vec6 = Eigen::Matrix<double, 6, 1>;

constexpr int kRoundsBakeSolve = 8,
              kHalvingsBakeSolve = 4;  // Newton steps, and halvings of a step, at most
constexpr double kEnough = 0.05;  // a step that reduces the cost by a smaller fraction is the last
// Ridge of the curves, and of the rotation and translation of helpers: sums over vertices of
// squared displacements, m^2, by a curve of 1, a rotation of 1 rad, and a fraction of the
// translation.
constexpr double kCurveRidge = 1e-6, kTurnRidge = 1e-3, kMoveRidge = 1e-1;

}  // namespace

// Newton's equations, the lower triangle; curves first, then rotation and translation of each
// helper.
struct FrameSolver::System {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  // of shapes: displacement of the vertex by each curve, times the root of its weights
  std::vector<Vec3> rows;
};

FrameSolver::FrameSolver(const Points& rest, const Eigen::MatrixXf& shapes,
                         std::span<const std::array<Influence, 4>> influences,
                         std::vector<Vec3> helpers)
    : rest_(rest),
      influences_(influences),
      helpers_(std::move(helpers)),
      morphs_(shapes.cols()),
      offsets_(influences.size()) {
  for (std::size_t i = 0; i < offsets_.size(); ++i)
    for (Index m = 0; m < morphs_; ++m)
      if (const Vec3 offset = shapes.col(m).segment<3>(3 * Index(i)).cast<double>();
          !offset.isZero(0))
        offsets_[i].push_back({m, offset});
}

Vec3 FrameSolver::shaped(std::size_t vertex, const Eigen::VectorXf& curves) const {
  Vec3 x = rest_.row(Index(vertex));
  for (const Offset& each : offsets_[vertex]) x += double(curves[each.shape]) * each.offset;
  return x;
}

Eigen::VectorXd FrameSolver::distances(const BakeFrame& frame,
                                       const Eigen::VectorXf& curves) const {
  Eigen::VectorXd out(rest_.rows());
  for (Index i = 0; i < out.size(); ++i)
    out[i] = (blended(influences_[i], frame.bones) * shaped(std::size_t(i), curves) -
              frame.exact.row(i).transpose().cast<double>())
                 .norm();
  return out;
}

void FrameSolver::add_vertex(std::size_t vertex, const BakeFrame& frame,
                             const Eigen::VectorXf& curves, bool least_squares,
                             System& system) const {
  const std::size_t joints = frame.bones.size() - helpers_.size();
  const Vec3 x = shaped(vertex, curves);
  const Eigen::Affine3d A = blended(influences_[vertex], frame.bones);
  const Vec3 off = A * x - frame.exact.row(Index(vertex)).transpose().cast<double>();
  const auto [R, r] = cost_root(off, least_squares);
  const Mat3 RA = R * A.linear();
  const auto& offsets = offsets_[vertex];
  system.rows.resize(offsets.size());
  for (std::size_t a = 0; a < offsets.size(); ++a) {
    const Vec3 row = RA * offsets[a].offset;
    system.rows[a] = row;
    system.g[offsets[a].shape] += row.dot(r);
    for (std::size_t b = 0; b <= a; ++b)
      system.H(offsets[a].shape, offsets[b].shape) += row.dot(system.rows[b]);
  }
  std::array<Eigen::Matrix<double, 3, 6>, 4> J;
  std::array<Index, 4> at;
  int count = 0;
  for (const Influence& influence : influences_[vertex]) {
    if (influence.weight <= 0 || std::size_t(influence.joint) < joints) continue;
    const std::size_t h = std::size_t(influence.joint) - joints, k = count++;
    const Vec3 arm = influence.weight * (frame.bones[influence.joint].linear() * (x - helpers_[h]));
    Mat3 turn;
    turn << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
    J[k].leftCols<3>() = R * turn;
    J[k].rightCols<3>() = influence.weight * R;
    at[k] = morphs_ + 6 * Index(h);
    system.g.segment<6>(at[k]) += J[k].transpose() * r;
    for (std::size_t a = 0; a < offsets.size(); ++a)
      system.H.col(offsets[a].shape).segment<6>(at[k]) += J[k].transpose() * system.rows[a];
    for (std::size_t b = 0; b <= k; ++b) {
      const bool below = at[k] >= at[b];
      const std::size_t low = below ? k : b, high = below ? b : k;
      system.H.block<6, 6>(at[low], at[high]) += J[low].transpose() * J[high];
    }
  }
}

void FrameSolver::step(const Eigen::VectorXd& by, double length, std::vector<Transform>& bones,
                       Eigen::VectorXf& curves) const {
  curves += (length * by.head(morphs_)).cast<float>();
  const std::size_t joints = bones.size() - helpers_.size();
  for (std::size_t h = 0; h < helpers_.size(); ++h) {
    Transform& T = bones[joints + h];
    const Index at = morphs_ + 6 * Index(h);
    const Vec3 turn = length * by.segment<3>(at),
               place = T * helpers_[h] + length * by.segment<3>(at + 3);
    const double angle = turn.norm();
    if (angle > 1e-15)
      T.linear() = (Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * T.linear()).eval();
    T.translation() = place - T.linear() * helpers_[h];
  }
}

Eigen::VectorXd FrameSolver::newton_step(const BakeFrame& frame, const Eigen::VectorXf& curves,
                                         bool least_squares, System& system) const {
  const Index n = morphs_ + 6 * Index(helpers_.size());
  system.H.setZero(n, n);
  system.g.setZero(n);
  for (std::size_t i = 0; i < influences_.size(); ++i)
    add_vertex(i, frame, curves, least_squares, system);
  system.H.diagonal().head(morphs_).array() += kCurveRidge;
  for (Index at = morphs_; at < n; at += 6) {
    system.H.diagonal().segment<3>(at).array() += kTurnRidge;
    system.H.diagonal().segment<3>(at + 3).array() += kMoveRidge;
  }
  return solve_llt_in_place(system.H, -system.g);
}

void FrameSolver::solve_least_squares(BakeFrame& frame, Eigen::VectorXf& curves) const {
  System system;
  curves = Eigen::VectorXf::Zero(morphs_);
  step(newton_step(frame, curves, true, system), 1, frame.bones, curves);
}

void FrameSolver::solve(BakeFrame& frame, Eigen::VectorXf& curves) const {
  solve_least_squares(frame, curves);
  System system;
  double now = cost_of(distances(frame, curves));
  for (int round = 0; round < kRoundsBakeSolve; ++round) {
    const Eigen::VectorXd by = newton_step(frame, curves, false, system);
    double then = now, length = 1;
    for (int halving = 0; halving < kHalvingsBakeSolve; ++halving, length /= 2) {
      const std::vector<Transform> bones = frame.bones;
      Eigen::VectorXf moved = curves;
      step(by, length, frame.bones, moved);
      if (const double there = cost_of(distances(frame, moved)); there < now) {
        then = there;
        curves = moved;
        break;
      }
      frame.bones = bones;
    }
    if (then > (1 - kEnough) * now) break;
    now = then;
  }
}

}  // namespace ecorche::inline v1
