// Rays against all bones at once, each of which knows its bone.
#pragma once

#include <optional>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/queries/ray_caster.h"

namespace ecorche::inline v1 {

struct BoneRays {
  SkinRays rays;          // coordinates to the micrometre
  std::vector<int> bone;  // #triangles, index into Anatomy::bones
};

// Precondition: there are bones. `even_about`: x of the plane about which muscles are even; bones
// of the middle, which never are quite, come with their mirror images then.
BoneRays make_bone_rays(const Anatomy& anatomy, std::optional<double> even_about);

}  // namespace ecorche::inline v1
