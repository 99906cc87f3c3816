// What of the fat layer has no muscle under it, and which sections would have to grow to get there.
#pragma once

#include <span>
#include <vector>

#include "anatomy/queries/ray_crossings.h"
#include "morph/dilation/packed_sections.h"
#include "morph/fat/fat_layer.h"

namespace ecorche {

// The layer's underside: one point a vertex of the skin, and the skin's unit normal there.
struct Underside {
  Points points, normals;
};
Underside underside(const TriMesh& skin, const FatLayer& fat);

// From each point of the underside a ray goes straight in. What muscle it meets first is asked to
// come up to it: the spokes of the sections at the triangle's corners, in proportion as they lean,
// and half as far those next to them. Returns, for each slice and direction, by how much it is
// asked to grow, m. `around`: where nothing lies within a centimetre straight in, what lies beside
// it is asked, too (six rays that lean by 58 degrees). `flesh`: rays against `F`, #F triangles of
// which the first are the surface's own; `solids`: #F, muscles, negative for bones.
std::vector<float> find_uncovered(const SharedSections& sections, const MuscleSurface& surface,
                                  const Underside& underside, const CrossingRays& flesh,
                                  const Triangles& F, std::span<const int> solids, bool around);

}  // namespace ecorche
