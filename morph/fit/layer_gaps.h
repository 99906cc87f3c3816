// How well the layer of fat and skin is filled from below: what `fit` and `check` both ask for.
#pragma once

#include <vector>

#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/types.h"
#include "morph/fat/fat_layer.h"

namespace ecorche::inline v1 {

// At least this share of the area is asked to be filled.
inline constexpr double kFilledAsked = 0.95;

// Filled: within 5 mm of muscle, bone or fascia, within a quarter of the layer's thickness, or in
// it.
struct LayerGaps {
  double filled_share = 0;     // of the area
  double median = 0, p95 = 0;  // m, of the gaps by area
};

// Vertices of the wall over limbs and trunk. `parts`: vertex_parts of its package.
std::vector<int> vertices_over_flesh(const TriMesh& wall, const std::vector<VertexPart>& parts);

// `wall`: of chest_wall_skin; `fat`: of its vertices; `parts`: vertex_parts of its package.
// `flesh`: muscles and bones as drawn; `fascia`: may have no triangles.
LayerGaps measure_layer_gaps(const TriMesh& wall, const FatLayer& fat,
                             const std::vector<VertexPart>& parts, const TriMesh& flesh,
                             const TriMesh& fascia);

}  // namespace ecorche::inline v1
