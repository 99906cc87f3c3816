// Surfaces as meshes to draw.
#pragma once

#include "anatomy/anatomy.h"
#include "viewer/draw_list.h"

namespace ecorche {

// Positions, vertex normals and triangles of the mesh.
DrawMesh make_draw_mesh(const TriMesh& mesh);

}  // namespace ecorche
