// Nearest-part skinning, the plainest anatomical skin: each vertex is attached to the one bone or
// muscle nearest to it at rest (after Wilhelms & Van Gelder 1997, 10.1145/258734.258833, without
// their elastic relaxation). A baseline.
#pragma once

#include <array>
#include <vector>

#include "anatomy/posing/pose_anatomy.h"
#include "skinning/binding.h"
#include "skinning/skin_frame.h"

namespace ecorche::inline v1 {

struct NearestPartSkin {
  struct PartAnchor {
    int part = 0;  // joint, or flat index of a slice
    bool muscle = false;
    // joint: the vertex in its frame; slice: the anchor, width and thickness in units of the radii
    Vec3 at = Vec3::Zero();
    Vec3 offset = Vec3::Zero();  // slice: from the anchor to the vertex in the slice's axes, m
    double weight = 0;
  };
  // #V; the second one is on the next slice of the same strip, or has no weight
  std::vector<std::array<PartAnchor, 2>> anchors;
  std::vector<int> triangles;  // 3 #F
};

// Precondition: `binding` and `rest` belong to the anatomy and the skin.
NearestPartSkin make_nearest_part_skin(const Anatomy& anatomy, const PosedAnatomy& rest,
                                       const TriMesh& skin, const Binding& binding);

void deform_nearest_part(const NearestPartSkin& skin, const PosedAnatomy& posed, SkinFrame& out);

}  // namespace ecorche::inline v1
