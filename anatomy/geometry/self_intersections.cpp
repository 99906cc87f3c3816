#include "anatomy/geometry/self_intersections.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <fmt/format.h>

#include <set>
#include <utility>
#include <vector>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {

int count_self_intersections(const Triangles& F, const Points& V) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
  Mesh mesh;
  mesh.reserve(static_cast<Mesh::size_type>(V.rows()), static_cast<Mesh::size_type>(3 * F.rows()),
               static_cast<Mesh::size_type>(F.rows()));
  for (Eigen::Index i = 0; i < V.rows(); ++i) mesh.add_vertex({V(i, 0), V(i, 1), V(i, 2)});
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    const auto corner = [&](int k) {
      return Mesh::Vertex_index(static_cast<Mesh::size_type>(F(f, k)));
    };
    if (mesh.add_face(corner(0), corner(1), corner(2)) == Mesh::null_face())
      throw UnfitError(fmt::format("triangle {} does not join its neighbours to a surface", f));
  }
  std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> pairs;
  CGAL::Polygon_mesh_processing::self_intersections(mesh, std::back_inserter(pairs));
  std::set<Mesh::Face_index> triangles;
  for (const auto& [a, b] : pairs) triangles.insert({a, b});
  return int(triangles.size());
}

}  // namespace ecorche::inline v1
