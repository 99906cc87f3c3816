// The skin that users have today: linear blend skinning with the body package's own rig and
// weights, driven by our joints.
#pragma once

#include <span>
#include <vector>

#include "anatomy/base_mesh/body_package.h"
#include "skinning/evaluation/blend_skinning.h"
#include "skinning/evaluation/rig_pose.h"

namespace ecorche::inline v1 {

struct LinearBaseline {
  Rig rig;  // the package's default rig, placed in this skin
  std::vector<RigLink> links;
  BlendSkin skin;
};

// Precondition: `skin` has the base mesh's topology and vertex order, in the skeleton's rest pose.
// Rig joints move from the package's undeformed shape with the skin around them, which is all that
// a bare skin tells of them.
LinearBaseline make_linear_baseline(const BodyPackage& package, const Skeleton& skeleton,
                                    const TriMesh& skin);

void deform_linear_baseline(const LinearBaseline& baseline, const Skeleton& skeleton,
                            std::span<const Transform> X_WJ, SkinFrame& out);

}  // namespace ecorche::inline v1
