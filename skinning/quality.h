// How good a deformed skin is, measured against its rest shape.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "anatomy/types.h"
#include "skinning/bind.h"
#include "skinning/skin_frame.h"

namespace ecorche {

// A piece of limb about a joint, closed by cutting planes that ride on the two neighbouring segments.
struct LimbSection {
  std::string name;                  // "elbow_l"
  int upper = 0, lower = 0;          // joints that carry the planes
  std::vector<int> triangles;        // of the skin, between the planes at rest
};

struct SkinQuality {
  int triangles = 0;
  int flipped = 0;                   // triangles that face against their turned rest normal
  double flipped_share = 0;
  double stretch_p99 = 1;            // 99th percentile of edge length / rest length
  double stretch_max = 1;
  double stretch_min = 1;
  int not_finite = 0;                // vertices with NaN or infinite coordinates
  std::vector<double> limb_volume_change;  // one a section, (V - V0) / V0
};

// Sections of both elbows and both knees: skin between planes half way along the segments above and below the joint.
std::vector<LimbSection> limb_sections(const Anatomy& anatomy, const TriMesh& skin, const Binding& binding);

// The same yardstick for every deformer: triangles are compared with their rest normal turned by the blended joint rotation of
// the binding, wherever `frame` comes from.
SkinQuality measure_skin(const TriMesh& rest, const Binding& binding, std::span<const LimbSection> sections,
                         const PosedAnatomy& posed, const SkinFrame& frame);

}  // namespace ecorche
