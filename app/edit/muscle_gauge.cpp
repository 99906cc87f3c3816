#include "app/edit/muscle_gauge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "anatomy/joint_angles.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/force_curves.h"
#include "anatomy/muscles/muscle_force.h"
#include "anatomy/muscles/tendon_compliance.h"
#include "anatomy/posing/pose_anatomy.h"

namespace ecorche {
namespace {

constexpr double kTaut = 1.3;  // of the optimal length: fibres pull by themselves from here on

// One muscle with the skeleton it moves with.
Anatomy alone(const Anatomy& anatomy, int muscle) {
  Anatomy out;
  out.skeleton = anatomy.skeleton;
  out.muscles = {anatomy.muscles[std::size_t(muscle)]};
  return out;
}

std::vector<double> lengths_in(const PosingTable& table, const Skeleton& skeleton, Pose pose,
                               int joint, int axis, double turn, double activation) {
  if (joint >= 0) {
    const Joint& turned = skeleton.joints[std::size_t(joint)];
    Quat& rotation = pose.rotations[std::size_t(joint)];
    Vec3 angles = joint_angles_near_limits(turned, rotation);
    angles[axis] += turn;
    rotation = joint_rotation(turned, angles);
    complete_pose(skeleton, pose);
  }
  PosedAnatomy posed;
  const double value[] = {activation};
  pose_anatomy(table, skeleton, pose, posed, 1, value);
  return posed.lengths;
}

double thickest(const std::vector<Ellipse>& slices) {
  double out = 0;
  for (const Ellipse& slice : slices) out = std::max(out, slice.radii.x() * slice.radii.y());
  return out;
}

double rest_length_of(const Muscle& muscle) {
  double out = 0;
  for (const Strip& strip : muscle.strips) out = std::max(out, strip.rest_length);
  return out;
}

double largest_force(const Muscle& muscle) {
  return muscle.max_force > 0 ? muscle.max_force
                              : isometric_force(muscle.volume, muscle.fibre_length);
}

}  // namespace

int joint_beside(const Skeleton& skeleton, const std::string& name, const std::string& side) {
  if (name.empty()) return -1;
  const int own = find_joint(skeleton, name);
  return own >= 0 ? own : find_joint(skeleton, name + side);
}

MuscleGauge::MuscleGauge(const Anatomy& anatomy, int muscle, int joint, int axis)
    : one_(alone(anatomy, muscle)),
      table_(make_posing_table(one_)),
      joint_(joint),
      axis_(axis),
      thickest_(thickest(rest_slices(one_))) {}

double MuscleGauge::length(const Pose& pose, double activation) const {
  return std::ranges::max(lengths_in(table_, one_.skeleton, pose, -1, 0, 0, activation));
}

double MuscleGauge::bulge(const Pose& pose, double activation) const {
  PosedAnatomy posed;
  const double value[] = {activation};
  pose_anatomy(table_, one_.skeleton, pose, posed, 1, value);
  return thickest_ > 0 ? std::sqrt(thickest(posed.slices) / thickest_) : 1;
}

double MuscleGauge::force(double length, double speed, double activation) const {
  const Muscle& muscle = one_.muscles.front();
  const double rest = rest_length_of(muscle), along = std::cos(muscle.pennation);
  if (!(muscle.fibre_length > 0) || !(rest > 0)) return 0;
  const double fibre = std::min(muscle.fibre_length, 0.95 * rest / along);
  const double slack = rest - fibre * along;
  const double shortening =
      isometric_shortening({muscle.fibre_length, muscle.pennation, rest}, length, activation);
  const double m = std::max((length - slack - shortening) / fibre, 0.0);
  const double l = std::hypot(m, std::sin(muscle.pennation)), cosine = l > 0 ? m / l : 0;
  const double v = speed * cosine / fibre / kFastestFibre;
  return largest_force(muscle) * cosine *
         (activation * active_force(l) * velocity_force(v) + passive_force(l - kTaut + 1));
}

std::optional<double> MuscleGauge::moment_arm(const Pose& pose, double activation) const {
  constexpr double kStep = 0.2 * kDegree;  // to either side, as docs/tables.md has it
  constexpr double kStill = 0.1e-3;        // m: arms below are none
  if (joint_ < 0) return std::nullopt;
  const auto turned = [&](double by) {
    return lengths_in(table_, one_.skeleton, pose, joint_, axis_, by, activation);
  };
  const std::vector<double> less = turned(-kStep), more = turned(kStep);
  double sum = 0;
  int crossing = 0;
  for (std::size_t k = 0; k < less.size(); ++k) {
    const double arm = (less[k] - more[k]) / (2 * kStep);
    if (std::abs(arm) < kStill) continue;
    sum += arm;
    ++crossing;
  }
  return crossing > 0 ? std::optional<double>(sum / crossing) : std::nullopt;
}

std::vector<double> speeds_of(const std::vector<double>& values, double fps) {
  std::vector<double> out(values.size(), 0);
  for (std::size_t k = 0; k < values.size() && values.size() > 1; ++k) {
    const std::size_t before = k > 0 ? k - 1 : 0, after = std::min(k + 1, values.size() - 1);
    out[k] = (values[after] - values[before]) * fps / double(after - before);
  }
  return out;
}

void add_frame(const MuscleGauge& gauge, const Pose& pose, double activation,
               MuscleCurves& curves) {
  curves.lengths.push_back(gauge.length(pose, activation));
  curves.efforts.push_back(activation);
  curves.bulges.push_back(gauge.bulge(pose, activation));
  curves.moment_arms.push_back(gauge.moment_arm(pose, activation));
}

void finish(const MuscleGauge& gauge, double fps, MuscleCurves& curves) {
  curves.speeds = speeds_of(curves.lengths, fps);
  curves.forces.clear();
  for (std::size_t k = 0; k < curves.lengths.size(); ++k)
    curves.forces.push_back(gauge.force(curves.lengths[k], curves.speeds[k], curves.efforts[k]));
}

std::string table_of(const MuscleCurves& curves, double fps) {
  std::string out = "seconds,length_mm,speed_mm_s,moment_arm_mm,activation,force_n,bulge\n";
  for (std::size_t k = 0; k < curves.lengths.size(); ++k) {
    const std::optional<double>& arm = curves.moment_arms[k];
    out += fmt::format("{:.4f},{:.3f},{:.2f},{},{:.3f},{:.2f},{:.4f}\n", double(k) / fps,
                       1e3 * curves.lengths[k], 1e3 * curves.speeds[k],
                       arm ? fmt::format("{:.3f}", 1e3 * *arm) : "", curves.efforts[k],
                       curves.forces[k], curves.bulges[k]);
  }
  return out;
}

MuscleFigures muscle_figures(const Anatomy& anatomy, int muscle, const Pose& pose,
                             const std::vector<double>& activation, int joint, int axis) {
  const Muscle& of = anatomy.muscles[std::size_t(muscle)];
  const MuscleGauge gauge(anatomy, muscle, joint, axis);
  const double effort = activation[std::size_t(muscle)];
  MuscleFigures out;
  out.rest_length = rest_length_of(of);
  out.length = gauge.length(pose, effort);
  out.volume = of.volume;
  out.fibre_length = of.fibre_length;
  out.force = of.max_force;
  out.moment_arm = gauge.moment_arm(pose, effort);
  return out;
}

}  // namespace ecorche
