// Shapes of part of a mesh, and of several meshes as one.
#pragma once

#include <span>

#include "skinning/morphs/mesh_shapes.h"
#include "skinning/morphs/shape_options.h"

namespace ecorche::inline v1 {

// The shapes of these vertices alone, by number.
MeshShapes shape_rows(const MeshShapes& shapes, std::span<const int> vertices);

// Several meshes as one, their vertices one after the other, with fewer shapes than they have
// together. The meshes' own errors add to what dropping leaves. Precondition: all have the same
// frames.
MeshShapes join_shapes(std::span<const MeshShapes> meshes, const ShapeOptions& options);

}  // namespace ecorche::inline v1
