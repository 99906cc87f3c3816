// How good a deformed skin is, measured against its rest shape.
#pragma once

#include <span>
#include <vector>

#include "anatomy/types.h"
#include "skinning/bind/blend_tables.h"
#include "skinning/bind/limb_sections.h"
#include "skinning/skin_frame.h"

namespace ecorche::inline v1 {

struct SkinQuality {
  int triangles = 0;
  int flipped = 0;  // triangles that face against their turned rest normal
  double flipped_share = 0;
  double stretch_p99 = 1;  // 99th percentile of edge length / rest length
  double stretch_max = 1;
  double stretch_min = 1;
  int not_finite = 0;                      // vertices with NaN or infinite coordinates
  std::vector<double> limb_volume_change;  // one a section, (V - V0) / V0
};

// Triangles that face against their rest normal turned by the blended rotation of the skin's blend
// frames (followed along the chain of joints, so that more than half a circle counts as such),
// wherever the shape V comes from. Preconditions: as of measure_skin(); otherwise
// std::invalid_argument.
std::vector<int> flipped_triangles(const TriMesh& rest, const BlendTables& tables,
                                   std::span<const Transform> X_WJ, const Points& V);

// The same yardstick for every deformer, wherever `frame` comes from.
// Precondition: posed.X_WJ and the positions are those of the tables' skeleton and skin.
SkinQuality measure_skin(const TriMesh& rest, const BlendTables& tables,
                         std::span<const LimbSection> sections, std::span<const Transform> X_WJ,
                         const SkinFrame& frame);

}  // namespace ecorche::inline v1
