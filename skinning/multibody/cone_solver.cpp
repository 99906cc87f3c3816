#include "skinning/multibody/cone_solver.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace ecorche::inline v1 {
namespace {

constexpr int kNewtonSteps = 60, kLineSteps = 40;
constexpr double kGradientLeft = 1e-10;  // of the largest part of A u

using Factor = Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>;

// Impulse of a contact whose velocity falls short of its target by `lack`: the nearest point of the
// friction cone, over the softness. Returns how many factors of its slope it has.
int press_contact(const ConeBlock& block, const Eigen::Vector3d& lack, Eigen::Vector3d& impulse,
                  Eigen::Matrix3d& factors) {
  const double mu = block.friction, soft = block.softness;
  const double sideways = lack.tail<2>().norm();
  if (sideways <= mu * lack[0]) {  // sticks
    impulse = lack / soft;
    factors = Eigen::Matrix3d::Identity() / std::sqrt(soft);
    return 3;
  }
  const double along = lack[0] + mu * sideways;
  if (along <= 0 || sideways == 0) {  // parts
    impulse.setZero();
    return 0;
  }
  const Eigen::Vector3d u(0, lack[1] / sideways, lack[2] / sideways);
  const Eigen::Vector3d edge = Eigen::Vector3d(1, mu * u[1], mu * u[2]);
  const double scale = 1 / ((1 + mu * mu) * soft);
  impulse = along * scale * edge;
  factors.col(0) = std::sqrt(scale) * edge;
  factors.col(1) = std::sqrt(mu * along * scale / sideways) * Eigen::Vector3d(0, -u[2], u[1]);
  return 2;
}

}  // namespace

void ConeSolver::begin(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  A_ = A;
  factor_ = A;
  const Factor factor(factor_);
  free_ = b;
  factor.solveInPlace(free_);
  blocks_.clear();
  used_ = 0;
}

void ConeSolver::reserve_columns(int count) {
  const int needed = used_ + count;
  if (columns_.rows() != A_.rows() || columns_.cols() < needed) {
    const int room = std::max(2 * needed, 64);
    columns_.conservativeResize(A_.rows(), room);
    target_.conservativeResize(room);
    curvature_.resize(A_.rows(), room);
  }
  columns_.middleCols(used_, count).setZero();
  used_ = needed;
}

int ConeSolver::add_limit(double target) {
  const int first = used_;
  reserve_columns(1);
  target_[first] = target;
  blocks_.push_back({first, false, 0, 0});
  return first;
}

int ConeSolver::add_contact(double friction, const Eigen::Vector3d& target) {
  const int first = used_;
  reserve_columns(3);
  target_.segment<3>(first) = target;
  blocks_.push_back({first, true, friction, 0});
  return first;
}

void ConeSolver::soften(double share) {
  for (ConeBlock& block : blocks_) {
    trial_ = columns_.col(block.first);
    factor_.triangularView<Eigen::Lower>().solveInPlace(trial_);
    block.softness = share * std::max(trial_.squaredNorm(), 1e-12);
  }
}

void ConeSolver::press(const Eigen::VectorXd& along, bool curved) {
  curved_ = 0;
  for (const ConeBlock& block : blocks_) {
    const int k = block.first;
    if (!block.contact) {
      const double lack = target_[k] - along[k];
      impulses_[k] = std::max(0.0, lack) / block.softness;
      if (curved && lack > 0)
        curvature_.col(curved_++) = columns_.col(k) / std::sqrt(block.softness);
      continue;
    }
    const Eigen::Vector3d lack = target_.segment<3>(k) - along.segment<3>(k);
    Eigen::Vector3d impulse;
    Eigen::Matrix3d factors;
    const int count = press_contact(block, lack, impulse, factors);
    impulses_.segment<3>(k) = impulse;
    if (!curved) continue;
    for (int f = 0; f < count; ++f)
      curvature_.col(curved_++).noalias() = columns_.middleCols<3>(k) * factors.col(f);
  }
}

// Where along the step the objective is least: the root of its slope, which rises.
double ConeSolver::search(const Eigen::VectorXd& step, const Eigen::VectorXd& along_v) {
  pull_.noalias() = A_ * step;
  const double bend = step.dot(pull_);
  const auto J = columns_.leftCols(used_);
  along_step_.noalias() = J.transpose() * step;
  // gradient_ has the impulses' part in it already; take A (v - u) alone.
  const double smooth = gradient_.dot(step) + impulses_.dot(along_step_);
  const auto slope = [&](double t) {
    trial_ = along_v + t * along_step_;
    press(trial_, false);
    return smooth + t * bend - impulses_.dot(along_step_);
  };
  double low = 0, high = 1, at_low = gradient_.dot(step), at_high = slope(1);
  const double enough = 1e-3 * std::abs(at_low);
  if (std::abs(at_high) <= enough) return 1;
  while (at_high < 0 && high < 1e6) {
    low = high, at_low = at_high;
    high *= 2;
    at_high = slope(high);
  }
  // Illinois' rule: the end that stays twice counts for half.
  double t = high;
  int stays = 0;
  for (int k = 0; k < kLineSteps; ++k) {
    t = low + (high - low) * at_low / (at_low - at_high);
    const double value = slope(t);
    if (std::abs(value) <= enough) break;
    if (value < 0) {
      low = t, at_low = value;
      if (stays < 0) at_high /= 2;
      stays = -1;
    } else {
      high = t, at_high = value;
      if (stays > 0) at_low /= 2;
      stays = 1;
    }
  }
  return t;
}

int ConeSolver::solve(double softness, Eigen::VectorXd& v) {
  impulses_.setZero(used_);
  if (blocks_.empty()) {
    v = free_;
    return 0;
  }
  soften(softness);
  const auto J = columns_.leftCols(used_);
  pull_.noalias() = A_ * free_;
  const double enough = kGradientLeft * std::max(1e-9, pull_.cwiseAbs().maxCoeff());
  for (int steps = 0; steps < kNewtonSteps; ++steps) {
    along_.noalias() = J.transpose() * v;
    press(along_, true);
    step_ = v - free_;
    gradient_.noalias() = A_ * step_;
    gradient_.noalias() -= J * impulses_;
    if (gradient_.cwiseAbs().maxCoeff() <= enough) return steps;
    hessian_ = A_;
    hessian_.selfadjointView<Eigen::Lower>().rankUpdate(curvature_.leftCols(curved_));
    const Factor factor(hessian_);
    step_ = -gradient_;
    factor.solveInPlace(step_);
    const double t = search(step_, along_);
    v += t * step_;
  }
  along_.noalias() = J.transpose() * v;
  press(along_, false);
  return kNewtonSteps;
}

}  // namespace ecorche::inline v1
