#include "skinning/lift/sheet.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "anatomy/geometry/mesh_measures.h"

namespace ecorche::inline v1 {

Sheet make_sheet(const TriMesh& mesh, const SheetMaterial& material) {
  if (mesh.F.rows() == 0) throw std::invalid_argument("make_sheet: no triangles");
  Sheet out;
  out.mesh = mesh;
  out.material = material;
  out.area = vertex_areas(mesh);
  for (const double area : out.area) out.mass.push_back(area * material.mass);
  out.around.resize(std::size_t(mesh.V.rows()));
  out.rim.assign(std::size_t(mesh.V.rows()), 0);
  std::map<std::pair<int, int>, int> known;
  std::vector<int> beside;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Eigen::RowVector3i t = mesh.F.row(f);
    const Vec3 p = mesh.V.row(t[0]).transpose();
    const double area =
        0.5 *
        (mesh.V.row(t[1]).transpose() - p).cross(Vec3(mesh.V.row(t[2]).transpose() - p)).norm();
    if (!(area > 1e-12)) throw std::invalid_argument("make_sheet: a triangle without area");
    std::array<int, 3> edges{};
    for (int k = 0; k < 3; ++k) {
      out.around[std::size_t(t[k])].push_back(int(f));
      const int i = std::max(t[k], t[(k + 1) % 3]), j = std::min(t[k], t[(k + 1) % 3]);
      const auto [at, fresh] = known.try_emplace({i, j}, int(out.springs.size()));
      if (fresh) {
        out.springs.push_back({i, j, (mesh.V.row(i) - mesh.V.row(j)).norm(), 0});
        beside.push_back(0);
      }
      SheetSpring& spring = out.springs[std::size_t(at->second)];
      spring.stiffness += material.stiffness * area / (spring.rest * spring.rest);
      ++beside[std::size_t(at->second)];
      edges[std::size_t(k)] = at->second;
    }
    out.edges_of.push_back(edges);
  }
  for (std::size_t i = 0; i < out.around.size(); ++i)
    if (out.around[i].empty()) throw std::invalid_argument("make_sheet: a node of no triangle");
  for (std::size_t e = 0; e < out.springs.size(); ++e)
    if (beside[e] == 1)
      out.rim[std::size_t(out.springs[e].a)] = out.rim[std::size_t(out.springs[e].b)] = 1;
  return out;
}

TriMesh rectangle(double width, double length, double z, double spacing) {
  // An even number of columns: left and right are mirror images.
  const int columns = std::max(2, 2 * int(std::lround(0.5 * width / spacing))),
            rows = std::max(1, int(std::lround(length / spacing)));
  TriMesh out;
  out.V.resize((rows + 1) * (columns + 1), 3);
  for (int r = 0; r <= rows; ++r)
    for (int c = 0; c <= columns; ++c)
      out.V.row(r * (columns + 1) + c) << width * (double(c) / columns - 0.5), 0,
          z + length * (double(r) / rows - 0.5);
  out.F.resize(2 * rows * columns, 3);
  int f = 0;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const int a = r * (columns + 1) + c, b = a + 1, d = a + columns + 1, e = d + 1;
      // Diagonals alternate, so that the cloth shears alike in both senses.
      if ((r + c) % 2 == 0) {
        out.F.row(f++) << a, d, e;
        out.F.row(f++) << a, e, b;
      } else {
        out.F.row(f++) << a, d, b;
        out.F.row(f++) << b, d, e;
      }
    }
  return out;
}

void add_strap(Sheet& sheet, const std::string& name, const Vec3& place, const Vec3& hook,
               double length, double radius) {
  Strap strap;
  strap.name = name;
  strap.hook = hook;
  strap.length = length;
  Eigen::Index nearest = 0;
  (sheet.mesh.V.rowwise() - place.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  double sum = 0;
  for (Eigen::Index i = 0; i < sheet.mesh.V.rows(); ++i) {
    const double distance = (sheet.mesh.V.row(i) - sheet.mesh.V.row(nearest)).norm();
    if (distance > radius) continue;
    strap.nodes.push_back(int(i));
    strap.shares.push_back(sheet.area[std::size_t(i)]);
    sum += strap.shares.back();
  }
  for (double& share : strap.shares) share /= sum;
  sheet.straps.push_back(std::move(strap));
}

}  // namespace ecorche::inline v1
