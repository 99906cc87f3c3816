#include "app/edit/trial_pose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "anatomy/joint_angles.h"
#include "anatomy/posing/pose_anatomy.h"
#include "anatomy/posing/posing_table.h"
#include "morph/placement/bone_groups.h"
#include "skinning/motion/activation.h"
#include "skinning/motion/pose_book.h"

namespace ecorche {
namespace {

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

}  // namespace

Pose trial_pose(Workshop& workshop, const Document& document, const Skeleton& skeleton,
                const Pose& start) {
  Pose out = start;
  const Trial& trial = *document.trial;
  if (!trial.pose.empty())
    for (NamedPose& pose :
         read_pose_book(workshop.assets().tables / "poses" / "poses.csv", skeleton))
      if (pose.name == trial.pose) out = std::move(pose.pose);
  for (const auto& [name, turned] : trial.angles)
    for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
      const Joint& joint = skeleton.joints[j];
      if (joint.name != name && split_side(joint.name).first != name) continue;
      Vec3 angles = joint_angles_near_limits(joint, out.rotations[j]);
      for (int axis = 0; axis < 3; ++axis)
        if (std::isfinite(turned[axis])) angles[axis] = turned[axis] * kDegree;
      out.rotations[j] = joint_rotation(joint, angles);
    }
  complete_pose(skeleton, out);
  return out;
}

std::vector<double> trial_activation(const Document& document, const Anatomy& anatomy) {
  std::vector<double> out(anatomy.muscles.size(), 0);
  for (const auto& [name, value] : document.trial->activations)
    for (const int muscle : muscles_meant(anatomy, name)) out[std::size_t(muscle)] = value;
  return out;
}

MuscleGauge::MuscleGauge(const Anatomy& anatomy, int muscle, double activation, int joint, int axis)
    : one_(alone(anatomy, muscle)),
      table_(make_posing_table(one_)),
      activation_(activation),
      joint_(joint),
      axis_(axis) {}

double MuscleGauge::length(const Pose& pose) const {
  return std::ranges::max(lengths_in(table_, one_.skeleton, pose, -1, 0, 0, activation_));
}

std::optional<double> MuscleGauge::moment_arm(const Pose& pose) const {
  constexpr double kStep = 0.2 * kDegree;  // to either side, as docs/tables.md has it
  constexpr double kStill = 0.1e-3;        // m: arms below are none
  if (joint_ < 0) return std::nullopt;
  const auto turned = [&](double by) {
    return lengths_in(table_, one_.skeleton, pose, joint_, axis_, by, activation_);
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

MuscleFigures muscle_figures(const Anatomy& anatomy, int muscle, const Pose& pose,
                             const std::vector<double>& activation, int joint, int axis) {
  const Muscle& of = anatomy.muscles[std::size_t(muscle)];
  const MuscleGauge gauge(anatomy, muscle, activation[std::size_t(muscle)], joint, axis);
  MuscleFigures out;
  for (const Strip& strip : of.strips)
    out.rest_length = std::max(out.rest_length, strip.rest_length);
  out.length = gauge.length(pose);
  out.volume = of.volume;
  out.fibre_length = of.fibre_length;
  out.force = of.max_force;
  out.moment_arm = gauge.moment_arm(pose);
  return out;
}

}  // namespace ecorche
