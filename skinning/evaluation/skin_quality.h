// How good a deformed skin is, measured against its rest shape.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "anatomy/types.h"
#include "skinning/bind/bind.h"
#include "skinning/skin_frame.h"

namespace ecorche {

// A piece of limb about a joint, from half way along the segment above to half way along the
// segment below. Its two ends are closed by fans about the centroids of their rims.
struct LimbSection {
  std::string name;            // "elbow_l"
  std::vector<int> triangles;  // of the skin
  std::vector<std::vector<std::array<int, 2>>>
      rims;  // directed edges of each open end, as the missing faces would wind
};

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

// Sections of the elbows and knees ("elbow_l", "elbow_r", "knee_l", "knee_r"); a joint that the
// skeleton lacks is left out.
std::vector<LimbSection> limb_sections(const Skeleton& skeleton, const TriMesh& skin,
                                       const Binding& binding);
std::vector<LimbSection> limb_sections(const Skeleton& skeleton, const TriMesh& skin,
                                       std::span<const std::array<Influence, 4>> joint_weights);

// The directed boundary of a set of triangles, reversed and chained into loops.
std::vector<std::vector<std::array<int, 2>>> open_rims(const std::vector<int>& triangles,
                                                       const Triangles& F);

// Volume of a section in the shape V, m^3.
double section_volume(const LimbSection& section, const Triangles& F, const Points& V);

// Triangles that face against their rest normal turned by the blended rotation of the binding's
// carriers (followed along the chain of joints, so that more than half a circle counts as such),
// wherever the shape V comes from. Preconditions: as of measure_skin(); otherwise
// std::invalid_argument.
std::vector<int> flipped_triangles(const TriMesh& rest, const Binding& binding,
                                   std::span<const Transform> X_WJ, const Points& V);

// The same yardstick for every deformer, wherever `frame` comes from.
// Precondition: posed.X_WJ and the positions are those of the binding's skeleton and skin.
SkinQuality measure_skin(const TriMesh& rest, const Binding& binding,
                         std::span<const LimbSection> sections, std::span<const Transform> X_WJ,
                         const SkinFrame& frame);

}  // namespace ecorche
