// Chooses the points of a skin that keep their height over the muscles, and spreads them over the
// vertices. Private to the room.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/posing/pose_anatomy.h"
#include "skinning/bind/blend_tables.h"
#include "skinning/bind/joint_weights.h"
#include "skinning/bind/skin_depth.h"

namespace ecorche {

// Nodes no nearer than `spacing` to each other along the skin, in vertex order; with the rings of
// neighbours for smoothing. node_rows: for each vertex the nodes it takes its lift from, weights
// summing to at most 1 (nodes without muscle count as zero). rows: the vertices' carriers. Fills
// tables.nodes.
std::vector<ShareRow> place_nodes(const Anatomy& anatomy, const PosedAnatomy& rest,
                                  const TriMesh& skin, const SkinSurvey& survey,
                                  const std::vector<ShareRow>& rows, double spacing,
                                  SkinTables& tables);

}  // namespace ecorche
