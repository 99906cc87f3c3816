// Lays the weights of a mesh out for the frame. Private to the room.
#pragma once

#include "skinning/bind/blend_tables.h"
#include "skinning/bind/skin_weights.h"

namespace ecorche::inline v1 {

// `root`: the root's origin at rest, which rest positions are stored relative to.
BlendMesh pack_mesh(const TriMesh& skin, const Vec3& root, const SkinWeights& weights);

}  // namespace ecorche::inline v1
