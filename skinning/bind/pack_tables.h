// Lays out the per-frame tables of a skin. Private to the room.
#pragma once

#include <memory>
#include <vector>

#include "skinning/bind/blend_tables.h"
#include "skinning/bind/joint_weights.h"

namespace ecorche {

// Fills everything of `tables` that belongs to vertices and triangles. rows: influences of
// carriers; node_rows: of nodes (may be shorter rows or none).
void lay_out(const TriMesh& skin, const std::vector<ShareRow>& rows,
             const std::vector<ShareRow>& node_rows, SkinTables& tables);

}  // namespace ecorche
