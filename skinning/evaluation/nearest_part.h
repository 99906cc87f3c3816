// The plainest anatomical skin: each vertex hangs on the one bone or muscle nearest to it at rest
// and is carried along (after Wilhelms & Van Gelder 1997, 10.1145/258734.258833, without their
// elastic relaxation). One of the deformers to beat.
#pragma once

#include <vector>

#include "anatomy/posing/pose_anatomy.h"
#include "skinning/bind/bind.h"
#include "skinning/skin_frame.h"

namespace ecorche {

struct PaperSkin {
  struct Hold {
    int part = 0;  // joint, or flat index of a slice
    bool muscle = false;
    // joint: the vertex in its frame; slice: the anchor, width and thickness in units of the radii
    Vec3 at = Vec3::Zero();
    Vec3 offset = Vec3::Zero();  // slice: from the anchor to the vertex in the slice's axes, m
    double weight = 0;
  };
  std::vector<std::array<Hold, 2>>
      holds;  // #V; the second one is the next slice of the same strip, or has no weight
  std::vector<int> triangles;  // 3 #F
};

// Precondition: `binding` and `rest` belong to the anatomy and the skin.
PaperSkin make_paper_skin(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin,
                          const Binding& binding);

void deform_paper(const PaperSkin& skin, const PosedAnatomy& posed, SkinFrame& out);

}  // namespace ecorche
