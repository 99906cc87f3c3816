#include "viewer/draw_mesh.h"

#include <cmath>
#include <cstdint>
#include <numbers>

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

void add_tube(const Vec3& from, const Vec3& to, double radius, int sides, DrawMesh& out) {
  const Vec3 along = to - from;
  if (along.norm() < 1e-7) return;
  const Vec3 u = along.unitOrthogonal(), v = along.normalized().cross(u);
  const std::uint32_t first = std::uint32_t(out.positions.size()), count = std::uint32_t(sides);
  for (int side = 0; side < sides; ++side) {
    const double angle = 2 * std::numbers::pi * side / sides;
    const Vec3 normal = std::cos(angle) * u + std::sin(angle) * v;
    for (const Vec3& end : {from, to}) {
      out.positions.push_back((end + radius * normal).cast<float>());
      out.normals.push_back(normal.cast<float>());
    }
  }
  for (std::uint32_t side = 0; side < count; ++side) {
    const std::uint32_t a = first + 2 * side, b = first + 2 * ((side + 1) % count);
    out.triangles.push_back({a, b, b + 1});
    out.triangles.push_back({a, b + 1, a + 1});
  }
}

}  // namespace ecorche
