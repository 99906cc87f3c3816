// Harmonic weights of a body's inside, and points placed in them: what of joints, of the skin and
// of the lattice moves a point that lies anywhere within the skin.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/queries/ray_caster.h"
#include "skinning/interior/map_points.h"
#include "skinning/interior/skin_controls.h"

namespace ecorche::inline v1 {

struct MapWeights {
  BodyLattice coarse, fine;
  std::vector<char> bone;                   // #coarse nodes, whether a bone holds it
  std::vector<SourceWeights> joints, skin;  // #fine nodes
  int skin_bone = 0;  // the source in `skin` that stands for bones, after the controls
};

// `skin`: closed but for small openings. `controls`: of it. Throws UnfitError where no bone lies in
// the skin.
MapWeights make_map_weights(const Anatomy& anatomy, const SkinRays& skin,
                            const SkinControls& controls);

// A bone that carries a point by a share, whatever lies about it.
struct BoneHold {
  int joint = -1;
  double share = 0;
};

// Joints that carry a point by a share instead of those about it, as where its muscle glides on a
// bone.
struct GlideHold {
  SourceWeights joints;
  double share = 0;
};

// `own`: #joints, from 0, others, which count less, to 1, those that move the point. Empty: all
// move it alike.
MapPoint place_point(const MapWeights& weights, const SkinRays& skin, const Vec3& point,
                     std::span<const double> own = {}, const BoneHold& hold = {},
                     const GlideHold& glide = {});

}  // namespace ecorche::inline v1
