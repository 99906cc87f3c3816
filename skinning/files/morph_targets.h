// Private to the writers of .glb files: shapes of meshes as morph targets, their curves as animated
// weights.
#pragma once

#include <utility>
#include <vector>

#include "anatomy/base_mesh/skin_texture.h"
#include "anatomy/character.h"
#include "skinning/files/clip_shapes.h"
#include "skinning/files/glb_builder.h"
#include "skinning/files/gltf_values.h"
#include "skinning/morphs/mesh_shapes.h"

namespace ecorche::inline v1::gltf {

// Mesh nodes and the shapes that they take.
using MorphedNodes = std::vector<std::pair<int, MeshShapes>>;

// Throws std::invalid_argument where shapes, if any, are not of this character and motion.
void check_shapes(const Character& character, const Motion* motion, const ClipShapes* shapes);

// Of a skin that is split along the seams of its texture.
MeshShapes seamed_shapes(const MeshShapes& skin, const SkinTexture& texture);

// Morph targets of all primitives of the nodes' meshes, whose weights are zero at rest, and their
// curves in the latest animation. times: accessor of its times, of which the curves have a row
// each. Nodes without shapes stay as they are. Precondition: no other node has their mesh.
void add_morphs(GlbBuilder& glb, const MorphedNodes& nodes, int times);

// What the file says of them, of the node `skin` and of muscles: how many shapes, and the error
// that they leave.
tinygltf::Value shapes_notes(const GlbBuilder& glb, const MorphedNodes& nodes);

}  // namespace ecorche::inline v1::gltf
