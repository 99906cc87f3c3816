// Binds a skin to the bones and muscles beneath it.
//
// Two parts move a vertex:
//   1. A blend of frames. Each vertex takes the joints of the bones beneath it (exact nearest
//      points, reached without leaving the body); the weights are diffused over the skin by a
//      screened Poisson solve whose length is the local depth of bone (after Baran & Popovic 2007,
//      10.1145/1276377.1276467); and where two joints move a vertex their half-way rotation about
//      the joint between them is blended in, so that a bent limb keeps its girth. All frames of the
//      blend are linear maps: x = sum_c w_c C_c(pose) X.
//   2. Muscle handles: a sparse set of points of the skin, each anchored to the strips beneath it.
//      A handle keeps its height over the posed muscle surface (fat and skin keep their thickness,
//      Wilhelms & Van Gelder 1997, 10.1145/258734.258833); muscles may slide underneath, so only
//      the height counts. The handles' offsets are interpolated at the vertices between them.
// blend_skin.h evaluates both. In the rest pose the input skin comes back; rigid motion is
// reproduced.
#pragma once

#include <memory>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/geometry/subdivide.h"
#include "anatomy/posing/pose_anatomy.h"
#include "skinning/bind/blend_tables.h"
#include "skinning/bind/painted_weights.h"
#include "skinning/binding.h"

namespace ecorche::inline v1 {

struct BoundSkin {
  Binding binding;
  std::shared_ptr<const BlendTables> blend;
  std::vector<double> depth;   // #V m, to the nearest bone
  std::vector<double> radius;  // #V m, half the thickness of the body beneath
};

// `rest`: the anatomy's rest pose. `painted`: vertices whose joint weights are taken as they are;
// what follows from weights (gradual twist of upper arm and thigh, half-way rotations, muscles) is
// found as ever, but the forearm's own spread between ulna and radius is left as it is painted.
// Throws UnfitError for a vertex that is not finite, for a skin without triangles, or an anatomy
// without bones. Precondition: the skin is the rest pose of the anatomy, closed enough to have an
// inside.
BoundSkin bind_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin,
                    const BindOptions& options = {}, const PaintedWeights& painted = {});

struct BoundRefinedSkin {
  Binding binding;  // of the fine skin; the anchors are its own
  std::shared_ptr<const BlendTables> blend;
  BoundSkin base;
};

// For a refined skin: weights are found on the base mesh and blended by the refinement, so that the
// fine skin moves as the base one does. Many times faster than binding the fine mesh by itself.
// Throws as bind_skin(). Precondition: fine.V = refine_points(refinement, base.V), or a shape near
// it with the same vertices.
BoundRefinedSkin bind_refined_skin(const Anatomy& anatomy, const PosedAnatomy& rest,
                                   const TriMesh& base, const Refinement& refinement,
                                   const TriMesh& fine, const BindOptions& options = {},
                                   const PaintedWeights& painted = {});

// Anchors and joint weights alone, for characters that are written and not moved: the same values
// as above in less time. Throws as bind_skin().
Binding bind_for_export(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin,
                        const BindOptions& options = {}, const PaintedWeights& painted = {});
Binding bind_for_export(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& base,
                        const Refinement& refinement, const TriMesh& fine,
                        const BindOptions& options = {}, const PaintedWeights& painted = {});

}  // namespace ecorche::inline v1
