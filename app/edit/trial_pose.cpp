#include "app/edit/trial_pose.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "anatomy/joint_angles.h"
#include "anatomy/posing/pose_anatomy.h"
#include "morph/placement/bone_groups.h"
#include "skinning/motion/pose_book.h"

namespace ecorche {
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

Activations trial_activations(const Document& document, const Anatomy& anatomy) {
  std::vector<const TriedEffort*> efforts(anatomy.muscles.size(), nullptr);
  for (const auto& [name, effort] : document.trial->activations)
    for (const int muscle : muscles_meant(anatomy, name)) efforts[std::size_t(muscle)] = &effort;
  Activations out{int(efforts.size()), {}};
  for (int m = 0; m < int(efforts.size()); ++m) {
    const TriedEffort* effort = efforts[std::size_t(m)];
    if (!effort) continue;
    ActivationCurve curve{{m}, {}, {}};
    for (const auto& [at, value] : effort->keys) {
      curve.times.push_back(at);
      curve.values.push_back(value);
    }
    if (effort->keys.empty()) curve = {{m}, {0}, {effort->value}};
    out.curves.push_back(std::move(curve));
  }
  return out;
}

std::vector<double> trial_activation(const Document& document, const Anatomy& anatomy,
                                     double seconds) {
  std::vector<double> out;
  activation_at(trial_activations(document, anatomy), seconds, out);
  out.resize(anatomy.muscles.size(), 0);
  return out;
}

}  // namespace ecorche
