// Points of a skin that keep their height over the muscles, and their weights for the vertices.
// Private to the room.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/posing/pose_anatomy.h"
#include "skinning/bind/skin_depth.h"
#include "skinning/bind/skin_weights.h"

namespace ecorche::inline v1 {

// Places handles no nearer than `spacing` (m) to each other along the skin, in vertex order, with
// the rings of neighbours for smoothing, into tables.handles. Returns for each vertex the handles
// that offset it, weights summing to at most 1 (handles over no muscle count as zero). rows: blend
// frames of the vertices.
std::vector<WeightRow> place_muscle_handles(const Anatomy& anatomy, const PosedAnatomy& rest,
                                            const TriMesh& skin, const SkinDepth& depth,
                                            const std::vector<WeightRow>& rows, double spacing,
                                            HandleTables& tables);

}  // namespace ecorche::inline v1
