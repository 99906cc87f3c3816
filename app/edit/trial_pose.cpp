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

MuscleFigures muscle_figures(const Anatomy& anatomy, int muscle, const Pose& pose,
                             const std::vector<double>& activation, int joint, int axis) {
  constexpr double kStep = 0.2 * kDegree;  // to either side, as docs/tables.md has it
  constexpr double kStill = 0.1e-3;        // m: arms below are none
  const Anatomy one = alone(anatomy, muscle);
  const PosingTable table = make_posing_table(one);
  const Muscle& of = one.muscles.front();
  const double effort = activation[std::size_t(muscle)];
  MuscleFigures out;
  for (const Strip& strip : of.strips)
    out.rest_length = std::max(out.rest_length, strip.rest_length);
  const std::vector<double> now = lengths_in(table, one.skeleton, pose, -1, 0, 0, effort);
  out.length = *std::ranges::max_element(now);
  out.volume = of.volume;
  out.fibre_length = of.fibre_length;
  out.force = of.max_force;
  if (joint < 0) return out;
  const std::vector<double> less =
      lengths_in(table, one.skeleton, pose, joint, axis, -kStep, effort);
  const std::vector<double> more =
      lengths_in(table, one.skeleton, pose, joint, axis, kStep, effort);
  double sum = 0;
  int crossing = 0;
  for (std::size_t k = 0; k < now.size(); ++k) {
    const double arm = (less[k] - more[k]) / (2 * kStep);
    if (std::abs(arm) < kStill) continue;
    sum += arm;
    ++crossing;
  }
  if (crossing > 0) out.moment_arm = sum / crossing;
  return out;
}

}  // namespace ecorche
