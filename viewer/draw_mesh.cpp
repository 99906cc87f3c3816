#include "viewer/draw_mesh.h"

#include <cstdint>

#include "anatomy/geometry/mesh_measures.h"

namespace ecorche {

DrawMesh make_draw_mesh(const TriMesh& mesh) {
  DrawMesh out;
  const Points normals = vertex_normals(mesh);
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
    out.positions.push_back(mesh.V.row(v).transpose().cast<float>());
    out.normals.push_back(normals.row(v).transpose().cast<float>());
  }
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    out.triangles.push_back(mesh.F.row(f).transpose().cast<std::uint32_t>());
  return out;
}

}  // namespace ecorche
