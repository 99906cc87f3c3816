#include "anatomy/geometry/simplify.h"

#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_placement.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include <array>
#include <vector>

#include "anatomy/geometry/tri_mesh_of.h"

namespace ecorche::inline v1 {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
namespace pmp = CGAL::Polygon_mesh_processing;
namespace sms = CGAL::Surface_mesh_simplification;

Mesh to_cgal(const TriMesh& mesh) {
  std::vector<Kernel::Point_3> points;
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    points.emplace_back(mesh.V(i, 0), mesh.V(i, 1), mesh.V(i, 2));
  std::vector<std::array<std::size_t, 3>> faces;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const auto corner = [&](int k) { return std::size_t(mesh.F(f, k)); };
    if (corner(0) != corner(1) && corner(1) != corner(2) && corner(2) != corner(0))
      faces.push_back({corner(0), corner(1), corner(2)});
  }
  pmp::orient_polygon_soup(points, faces);
  Mesh out;
  pmp::polygon_soup_to_polygon_mesh(points, faces, out);
  return out;
}

// To the nearest of the whole mesh's vertices, each of which is taken once.
void snap(const Points& whole, Points& V) {
  const std::vector<int> nearest = nearest_rows(V, whole);
  std::vector<bool> taken(whole.rows(), false);
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    const std::size_t row = nearest[i];
    if (taken[row]) continue;
    taken[row] = true;
    V.row(i) = whole.row(row);
  }
}

}  // namespace

TriMesh simplify(const TriMesh& mesh, int triangles) {
  if (mesh.F.rows() <= triangles) return mesh;
  Mesh work = to_cgal(mesh);
  // A closed surface has three edges for two triangles.
  const std::size_t edges = 1.5 * triangles;
  using Policies = sms::GarlandHeckbert_policies<Mesh, Kernel>;
  const Policies policies(work);
  const sms::Bounded_normal_change_placement<Policies::Get_placement> placement(
      policies.get_placement());
  sms::edge_collapse(work, sms::Count_stop_predicate<Mesh>(edges),
                     CGAL::parameters::get_cost(policies.get_cost()).get_placement(placement));
  work.collect_garbage();
  TriMesh out = tri_mesh_of(work);
  snap(mesh.V, out.V);
  return out;
}

std::vector<int> nearest_rows(const Points& from, const Points& to) {
  std::vector<int> out(from.rows());
  for (Eigen::Index i = 0; i < from.rows(); ++i)
    (to.rowwise() - from.row(i)).rowwise().squaredNorm().minCoeff(&out[i]);
  return out;
}

}  // namespace ecorche::inline v1
