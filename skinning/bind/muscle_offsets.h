// Offsets of the skin's handles by the muscles beneath them. Private to the room.
#pragma once

#include <vector>

#include "anatomy/posing/pose_anatomy.h"
#include "skinning/bind/blend_tables.h"

namespace ecorche::inline v1 {

// Offsets of the handles in one pose, and the memory they are made in. Sized on first use.
struct HandleWorkspace {
  std::vector<float> offsets;   // #handles x 4, world, m, the last 0
  std::vector<float> smoothed;  // the same; working memory
};

// Sets each handle's rest height: the depth of its rest point below the smooth tube, from which
// offsets are measured.
void level_handles(const PosedAnatomy& rest, HandleTables& tables);

// Offset of every handle along its posed normal, by the change of height of the muscle surface
// beneath it against the blended skin. Muscles slide along their line underneath; the slice that
// has come to lie beneath the handle counts, so that only the section's size and place offset the
// skin. `maps`: of FrameWorkspace.
void offset_handles(const BlendTables& tables, const PosedAnatomy& posed,
                    const std::vector<float>& maps, HandleWorkspace& out);

}  // namespace ecorche::inline v1
