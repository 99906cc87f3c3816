// Surfaces as meshes to draw.
#pragma once

#include "anatomy/anatomy.h"
#include "viewer/draw_list.h"

namespace ecorche {

// Positions, vertex normals and triangles of the mesh.
DrawMesh make_draw_mesh(const TriMesh& mesh);

// Adds a tube of so many flat sides without ends, smoothly shaded; nothing where both ends are in
// one place.
void add_tube(const Vec3& from, const Vec3& to, double radius, int sides, DrawMesh& out);

}  // namespace ecorche
