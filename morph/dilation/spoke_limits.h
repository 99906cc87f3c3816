// Radial limits of every section in each direction of its outline: the distance to the layer of
// fat, and how far an outline may press into it. Private to pack_muscles.
#pragma once

#include <span>
#include <vector>

#include "anatomy/queries/ray_caster.h"
#include "morph/dilation/fill_gaps.h"
#include "morph/dilation/packed_sections.h"
#include "morph/fat/fat_layer.h"

namespace ecorche::inline v1 {

// m.
struct RadialLimit {
  float base = 0;      // the drawn ellipse's radius
  float layer = 1e3f;  // to the layer of fat
  float over = 1e3f;   // as far as a tip may stand, so that the facets about it lie on the layer
  float most = 1e3f;   // to where the layer has given as far as it can
};

struct RadialLimits {
  // #slices x #directions; as above where a direction moves no vertex, or belongs to its partner's
  // mirror image
  std::vector<RadialLimit> spokes;
  long long rays = 0;  // that were cast
};

// `skin`, `fat`: closed, and the layer beneath it; `underside`: of that. `skin_gap`: m that an
// ellipse keeps from the skin where it presses into the layer.
// `asked`: #muscles; the others' limits stay open.
RadialLimits find_radial_limits(const PackedSections& all, std::span<const char> asked,
                                const SkinRays& skin, const FatLayer& fat,
                                const Underside& underside, double skin_gap);

}  // namespace ecorche::inline v1
