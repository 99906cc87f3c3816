// From a library's half-edge mesh to ours. Private to the library.
#pragma once

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// `mesh`: a CGAL::Surface_mesh of triangles whose removed elements are collected as garbage, so
// that its vertices and faces are numbered without gaps.
template <class SurfaceMesh>
TriMesh tri_mesh_of(const SurfaceMesh& mesh) {
  TriMesh out{Points(mesh.number_of_vertices(), 3), Triangles(mesh.number_of_faces(), 3)};
  for (const auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    out.V.row(v.idx()) << p.x(), p.y(), p.z();
  }
  for (const auto f : mesh.faces()) {
    int k = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f)))
      out.F(f.idx(), k++) = int(v.idx());
  }
  return out;
}

}  // namespace ecorche::inline v1
