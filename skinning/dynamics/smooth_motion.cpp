#include "skinning/dynamics/smooth_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ecorche::inline v1 {
namespace {

constexpr double kHighestCutoff = 0.45;  // of the frame rate: beyond it there is nothing to cut
constexpr double kTwoPasses = 0.802;     // (sqrt(2) - 1)^(1/4): one pass' corner for two passes'
constexpr double kLeadIn = 2;            // periods of the cut-off, beyond either end

struct Filter {
  double b0, b1, b2, a1, a2;
};

Filter butterworth(double fps, double cutoff) {
  const double w = std::tan(std::numbers::pi * cutoff / fps) / kTwoPasses,
               k1 = std::numbers::sqrt2 * w, k2 = w * w, a0 = k2 / (1 + k1 + k2);
  return {a0, 2 * a0, a0, 2 * a0 * (1 / k2 - 1), 1 - (4 * a0 + 2 * a0 * (1 / k2 - 1))};
}

// In place, from rest at the first value.
void run(const Filter& f, std::vector<double>& x) {
  double x1 = x[0], x2 = x[0], y1 = x[0], y2 = x[0];
  for (double& value : x) {
    const double y = f.b0 * value + f.b1 * x1 + f.b2 * x2 + f.a1 * y1 + f.a2 * y2;
    x2 = x1;
    x1 = value;
    y2 = y1;
    y1 = y;
    value = y;
  }
}

// The turn from one rotation to another, in axes of the frame that both are in.
Vec3 turn_between(const Quat& from, const Quat& to) {
  Quat q = to * from.conjugate();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  if (sine < 1e-12) return 2 * q.vec();
  return 2 * std::atan2(sine, q.w()) / sine * q.vec();
}

}  // namespace

void low_pass(double fps, double cutoff, Eigen::MatrixXd& columns) {
  const Eigen::Index n = columns.rows();
  if (!(cutoff > 0) || cutoff >= kHighestCutoff * fps || n < 3) return;
  const Filter filter = butterworth(fps, cutoff);
  const Eigen::Index lead =
      std::min<Eigen::Index>(n - 1, Eigen::Index(std::ceil(kLeadIn * fps / cutoff)));
  std::vector<double> x(n + 2 * lead);
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    const auto column = columns.col(c);
    for (Eigen::Index i = 0; i < n; ++i) x[lead + i] = column[i];
    for (Eigen::Index i = 1; i <= lead; ++i) {
      x[lead - i] = 2 * column[0] - column[i];
      x[lead + n - 1 + i] = 2 * column[n - 1] - column[n - 1 - i];
    }
    run(filter, x);
    std::reverse(x.begin(), x.end());
    run(filter, x);
    std::reverse(x.begin(), x.end());
    for (Eigen::Index i = 0; i < n; ++i) columns(i, c) = x[lead + i];
  }
}

std::vector<MotionState> smooth_motion(const Motion& motion, double cutoff) {
  const Eigen::Index n = Eigen::Index(motion.frames.size());
  const Eigen::Index joints = Eigen::Index(motion.frames[0].rotations.size());
  Eigen::MatrixXd values(n, 3 + 4 * joints);
  for (Eigen::Index f = 0; f < n; ++f) {
    const Pose& pose = motion.frames[f];
    values.row(f).head<3>() = pose.root;
    for (Eigen::Index j = 0; j < joints; ++j) {
      Eigen::Vector4d q = pose.rotations[j].coeffs();
      if (f > 0 && q.dot(values.row(f - 1).segment<4>(3 + 4 * j)) < 0) q = -q;
      values.row(f).segment<4>(3 + 4 * j) = q;
    }
  }
  low_pass(motion.fps, cutoff, values);
  std::vector<MotionState> out(n);
  for (Eigen::Index f = 0; f < n; ++f) {
    out[f].pose.root = values.row(f).head<3>();
    for (Eigen::Index j = 0; j < joints; ++j)
      out[f].pose.rotations.push_back(
          Quat(Eigen::Vector4d(values.row(f).segment<4>(3 + 4 * j))).normalized());
    out[f].rates.assign(joints, Vec3::Zero());
    out[f].turn_accelerations.assign(joints, Vec3::Zero());
  }
  const double fps = motion.fps;
  for (Eigen::Index f = 1; f + 1 < n; ++f) {
    const Pose &before = out[f - 1].pose, &now = out[f].pose, &after = out[f + 1].pose;
    out[f].root_velocity = 0.5 * fps * (after.root - before.root);
    out[f].root_acceleration = fps * fps * (after.root - 2 * now.root + before.root);
    for (Eigen::Index j = 0; j < joints; ++j) {
      const Vec3 first = turn_between(before.rotations[j], now.rotations[j]),
                 second = turn_between(now.rotations[j], after.rotations[j]);
      out[f].rates[j] = 0.5 * fps * (first + second);
      out[f].turn_accelerations[j] = fps * fps * (second - first);
    }
  }
  if (n >= 3)
    for (const auto& [end, inside] :
         {std::pair<Eigen::Index, Eigen::Index>{0, 1}, {n - 1, n - 2}}) {
      const Pose pose = out[end].pose;
      out[end] = out[inside];
      out[end].pose = pose;
    }
  return out;
}

}  // namespace ecorche::inline v1
