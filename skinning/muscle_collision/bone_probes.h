// Probes of bones: points of them that are near the skin at rest, against the skin in a pose.
// Private to the room.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "skinning/muscle_collision/collision_workspace.h"
#include "skinning/muscle_collision/project_to_skin.h"

namespace ecorche::inline v1 {

struct BoneProbe {
  int joint = 0;
  Eigen::Vector3f place = Eigen::Vector3f::Zero();  // m, from the joint at rest
  int vertex = 0;                                   // of the skin, nearest at rest
  float margin = 0;  // m, that the point stays below the skin: not more than its depth at rest
};

// For each joint and vertex of the skin the points nearest to it, ordered by joint.
std::vector<BoneProbe> place_bone_probes(const Anatomy& anatomy, const TriMesh& skin,
                                         const SkinRings& rings);

// Fills `out` with the probes that are not their margin below the skin, at any number of threads in
// the same order.
void find_bone_penetrations(std::span<const BoneProbe> probes, std::span<const Transform> X_WJ,
                            const SkinRings& rings, const PosedSkin& skin,
                            std::vector<std::vector<SkinPenetration>>& blocks,
                            std::vector<SkinPenetration>& out);

}  // namespace ecorche::inline v1
