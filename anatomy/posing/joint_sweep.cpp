#include "anatomy/posing/joint_sweep.h"

#include <array>
#include <cmath>
#include <stdexcept>

namespace ecorche::inline v1 {
namespace {

void keep_larger(SweepJump& worst, double size, const JointSweep& sweep, double angle) {
  if (!(size > worst.size)) return;
  worst = {size, sweep.joint, sweep.axis, angle};
}

double second_difference(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (a - 2 * b + c).norm();
}

// The three successive poses `p` of one strip.
void compare(const std::array<const PosedAnatomy*, 3>& p, const SliceRange& range,
             const JointSweep& sweep, double angle, StripSweep& worst) {
  for (int k = range.begin; k < range.end; ++k) {
    const Ellipse &a = p[0]->slices[k], &b = p[1]->slices[k], &c = p[2]->slices[k];
    keep_larger(worst.center, second_difference(a.center, b.center, c.center), sweep, angle);
    for (int axis = 0; axis < 2; ++axis) {
      const auto rim = [&](const Ellipse& e) -> Vec3 {
        return e.center + e.radii[axis] * e.axes.col(axis);
      };
      keep_larger(worst.rim, second_difference(rim(a), rim(b), rim(c)), sweep, angle);
    }
  }
}

}  // namespace

std::vector<JointSweep> joint_sweeps(const Skeleton& skeleton, double step) {
  if (!(step > 0) || !std::isfinite(step))
    throw std::invalid_argument("joint_sweeps: step " + std::to_string(step));
  std::vector<JointSweep> sweeps;
  for (int j = 1; j < int(skeleton.joints.size()); ++j)
    for (int axis = 0; axis < 3; ++axis) {
      const double low = skeleton.joints[j].min[axis], high = skeleton.joints[j].max[axis];
      if (high - low <= 2 * step * (1 + 1e-9)) continue;
      JointSweep sweep{j, axis, {}};
      const int count = std::ceil((high - low) / step - 1e-9);
      for (int i = 0; i <= count; ++i) sweep.angles.push_back(low + (high - low) * i / count);
      sweeps.push_back(std::move(sweep));
    }
  return sweeps;
}

Pose swept_pose(const Skeleton& skeleton, int joint, int axis, double angle) {
  const Joint& of = skeleton.joints[joint];
  // The axes before this one have turned it; a mirrored side's third axis counts the other way
  // round (see Joint::zero).
  Mat3 A = of.axes;
  Vec3 zero = of.zero;
  if (A.determinant() < 0) {
    A.col(2) = -A.col(2);
    zero[2] = -zero[2];
    if (axis == 2) angle = -angle;
  }
  Quat before = Quat::Identity();
  for (int i = 0; i < axis; ++i) before = before * Quat(Eigen::AngleAxisd(zero[i], Vec3::Unit(i)));
  Pose pose = rest_pose(skeleton);
  pose.rotations[joint] =
      Quat(Eigen::AngleAxisd(angle - zero[axis], A * (before * Vec3::Unit(axis))));
  complete_pose(skeleton, pose);
  return pose;
}

Eigen::MatrixXd swept_lengths(const PosingTable& table, const Skeleton& skeleton,
                              const JointSweep& sweep) {
  Eigen::MatrixXd lengths(sweep.angles.size(), table.strips());
  PosedAnatomy posed;
  for (size_t i = 0; i < sweep.angles.size(); ++i) {
    pose_anatomy(table, skeleton, swept_pose(skeleton, sweep.joint, sweep.axis, sweep.angles[i]),
                 posed);
    for (int strip = 0; strip < table.strips(); ++strip) lengths(i, strip) = posed.lengths[strip];
  }
  return lengths;
}

std::vector<StripSweep> measure_sweeps(const PoseMuscles& pose_muscles, const Skeleton& skeleton,
                                       const std::vector<SliceRange>& ranges,
                                       const std::vector<JointSweep>& sweeps) {
  std::vector<StripSweep> worst(ranges.size());
  PosedAnatomy rest;
  pose_muscles(rest_pose(skeleton), rest);
  std::vector<double> volume;
  for (const SliceRange& range : ranges) volume.push_back(strip_volume(rest, range));
  std::array<PosedAnatomy, 3> posed;
  for (const JointSweep& sweep : sweeps) {
    for (size_t i = 0; i < sweep.angles.size(); ++i) {
      PosedAnatomy& now = posed[i % 3];
      pose_muscles(swept_pose(skeleton, sweep.joint, sweep.axis, sweep.angles[i]), now);
      const std::array<const PosedAnatomy*, 3> three{&posed[(i + 1) % 3], &posed[(i + 2) % 3],
                                                     &now};
      for (size_t strip = 0; strip < ranges.size(); ++strip) {
        StripSweep& of = worst[strip];
        keep_larger(of.drift, std::abs(strip_volume(now, ranges[strip]) / volume[strip] - 1), sweep,
                    sweep.angles[i]);
        if (i < 2) continue;
        const double bend =
            three[0]->lengths[strip] - 2 * three[1]->lengths[strip] + three[2]->lengths[strip];
        keep_larger(of.length, std::abs(bend), sweep, sweep.angles[i - 1]);
        compare(three, ranges[strip], sweep, sweep.angles[i - 1], of);
      }
    }
  }
  return worst;
}

std::vector<StripSweep> measure_sweeps(const PosingTable& table, const Skeleton& skeleton,
                                       const std::vector<SliceRange>& ranges,
                                       const std::vector<JointSweep>& sweeps, int threads) {
  return measure_sweeps(
      [&](const Pose& pose, PosedAnatomy& posed) {
        pose_anatomy(table, skeleton, pose, posed, threads);
      },
      skeleton, ranges, sweeps);
}

}  // namespace ecorche::inline v1
