// The skin that users have today: linear blend skinning with the body package's own rig and
// weights, driven by our joints.
#pragma once

#include <vector>

#include "anatomy/base_mesh/body_package.h"
#include "skinning/evaluation/blend_skinning.h"
#include "skinning/evaluation/rig_pose.h"

namespace ecorche {

struct LinearRival {
  Rig rig;  // the package's default rig, placed in this skin
  std::vector<RigLink> links;
  BlendSkin skin;
};

// Precondition: `skin` has the base mesh's topology and vertex order, in the skeleton's rest pose.
// Rig joints are carried from the package's undeformed shape by the skin around them, as far as a
// bare skin tells where they are.
LinearRival make_linear_rival(const BodyPackage& package, const Skeleton& skeleton,
                              const TriMesh& skin);

void deform_rival(const LinearRival& rival, const Skeleton& skeleton,
                  std::span<const Transform> X_WJ, SkinFrame& out);

}  // namespace ecorche
