#include "skinning/markers/marker_calibration.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "anatomy/compute/cholesky.h"

namespace ecorche::inline v1 {
namespace {

constexpr Eigen::Index kSizes = Eigen::Index(kFigureSizes.size());
constexpr double kSpreadOfStature = 0.15, kSpreadOfParts = 0.05;  // of sizes, about their mean
// Skin slides alike in all frames: so many of them count as each on its own. More lets the markers'
// sliding bend the skeleton, fewer holds it to the body's own proportions.
constexpr double kIndependentFrames = 10;
constexpr int kRounds = 25;
constexpr double kSettled = 1e-5;  // of the cost

struct SharedSystem {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  double cost = 0;
};

SharedSystem priors(const MarkerModel& model, double weight) {
  const Eigen::Index n = kSizes + 3 * Eigen::Index(model.markers.size());
  SharedSystem out{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  // (s - mean(s)) / parts, and (mean(s) - 1) / stature
  const Eigen::MatrixXd mean = Eigen::MatrixXd::Constant(kSizes, kSizes, 1.0 / double(kSizes));
  const Eigen::MatrixXd P =
      (Eigen::MatrixXd::Identity(kSizes, kSizes) - mean) / std::pow(kSpreadOfParts, 2) +
      mean / (std::pow(kSpreadOfStature, 2));
  const Eigen::VectorXd off = model.figure.sizes - FigureSizes::Ones();
  out.H.topLeftCorner(kSizes, kSizes) = weight * P;
  out.g.head(kSizes) = weight * P * off;
  out.cost = 0.5 * weight * off.dot(P * off);
  for (std::size_t m = 0; m < model.markers.size(); ++m) {
    const Eigen::Index at = kSizes + 3 * Eigen::Index(m);
    const double precision = weight / std::pow(model.markers[m].spread, 2);
    out.H.diagonal().segment<3>(at).array() += precision;
    out.g.segment<3>(at) += precision * model.offsets[m];
    out.cost += 0.5 * precision * model.offsets[m].squaredNorm();
  }
  return out;
}

void move_shared(const Eigen::VectorXd& step, MarkerModel& model) {
  FigureSizes sizes = model.figure.sizes + step.head<kSizes>();
  set_sizes(sizes.cwiseMax(0.4).cwiseMin(2.0), model.figure);
  for (std::size_t m = 0; m < model.markers.size(); ++m)
    model.offsets[m] += step.segment<3>(kSizes + 3 * Eigen::Index(m));
}

class Calibration {
 public:
  Calibration(const std::vector<Points>& frames, MarkerModel& model, std::vector<FigurePose>& poses)
      : frames_(frames), model_(model), poses_(poses), systems_(frames.size()) {}

  void run() {
    double cost = assemble(model_, poses_, systems_), damping = 1e-4;
    std::vector<PoseSystem> next(frames_.size());
    for (int round = 0; round < kRounds; ++round) {
      MarkerModel there = model_;
      std::vector<FigurePose> poses = poses_;
      step(damping, there, poses);
      const double now = assemble(there, poses, next);
      if (now > cost) {
        damping *= 10;
        if (damping > 1e4) break;
        continue;
      }
      const double gained = cost - now;
      model_ = std::move(there);
      poses_ = std::move(poses);
      std::swap(systems_, next);
      cost = now;
      damping = std::max(1e-6, damping * 0.1);
      if (gained < kSettled * cost) break;
    }
  }

 private:
  double weight() const { return std::max(1.0, double(frames_.size()) / kIndependentFrames); }

  double assemble(const MarkerModel& model, const std::vector<FigurePose>& poses,
                  std::vector<PoseSystem>& out) const {
    tbb::parallel_for(std::size_t{0}, frames_.size(), [&](std::size_t f) {
      assemble_pose(model, frames_[f], {}, nullptr, poses[f], true, out[f]);
    });
    double cost = priors(model, weight()).cost;
    for (const PoseSystem& system : out) cost += system.cost;
    return cost;
  }

  // The step of what is shared solves the system that is left when poses are eliminated; each
  // frame's pose follows.
  void step(double damping, MarkerModel& model, std::vector<FigurePose>& poses) const {
    SharedSystem sum = priors(model, weight());
    std::vector<Eigen::MatrixXd> follows(frames_.size());
    std::vector<Eigen::VectorXd> alone(frames_.size());
    tbb::parallel_for(std::size_t{0}, frames_.size(), [&](std::size_t f) {
      Eigen::MatrixXd H = systems_[f].H;
      H.diagonal() *= 1 + damping;
      H.diagonal().array() += 1e-3;
      const CholeskyFactor factor(H);
      follows[f] = factor.solve_columns(systems_[f].mixed);
      alone[f] = factor.solve(systems_[f].g);
    });
    for (std::size_t f = 0; f < frames_.size(); ++f) {
      sum.H += Eigen::MatrixXd(systems_[f].shared.selfadjointView<Eigen::Lower>()) -
               systems_[f].mixed.transpose() * follows[f];
      sum.g += systems_[f].shared_g - systems_[f].mixed.transpose() * alone[f];
    }
    sum.H.diagonal() *= 1 + damping;
    const Eigen::VectorXd shared = -solve_llt(sum.H, sum.g);
    move_shared(shared, model);
    for (std::size_t f = 0; f < frames_.size(); ++f) {
      Eigen::VectorXd pose = -alone[f] - follows[f] * shared;
      const double largest = pose.tail(pose.size() - 3).cwiseAbs().maxCoeff();
      if (largest > 0.6) pose *= 0.6 / largest;
      move_figure(model.figure, pose, poses[f]);
    }
  }

  const std::vector<Points>& frames_;
  MarkerModel& model_;
  std::vector<FigurePose>& poses_;
  std::vector<PoseSystem> systems_;
};

}  // namespace

void calibrate_markers(const std::vector<Points>& frames, MarkerModel& model,
                       std::vector<FigurePose>& poses) {
  Calibration(frames, model, poses).run();
}

}  // namespace ecorche::inline v1
