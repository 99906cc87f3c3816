// Drives a rig of the body package with the pose of our skeleton, so that its own weights can be
// compared with ours.
#pragma once

#include <span>
#include <vector>

#include "anatomy/base_mesh/body_package.h"
#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// The joints that give a rig bone its rotation: slerp(joint, other, share), or the joint's without
// its axial rotation.
struct RigLink {
  int joint = -1;
  int other = -1;    // -1: the joint alone
  double share = 0;  // of the other
  // >= 0: half the axial rotation of this joint is left out (upper arm and thigh, first half)
  int twist_of = -1;
  Vec3 axis = Vec3::UnitY();
};

// Links by the names of the default rig (163 bones); a bone of no known name follows its parent.
// #bones
std::vector<RigLink> link_default_rig(const Rig& rig, const Skeleton& skeleton);

// World maps of the rig's bones from rest to pose. Rotations come from our joints; positions from
// the rig's own hierarchy, its root carried by our root joint. out: #bones.
void pose_rig(const Rig& rig, std::span<const RigLink> links, const Skeleton& skeleton,
              std::span<const Transform> X_WJ, std::vector<Transform>& out);

}  // namespace ecorche::inline v1
