#include "anatomy/bones/bone_surface.h"

#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/ModifiedButterFlyT.hh>

#include <algorithm>
#include <cmath>
#include <vector>

#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/geometry/simplify.h"
#include "anatomy/geometry/tri_mesh_of.h"

namespace ecorche::inline v1 {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
namespace pmp = CGAL::Polygon_mesh_processing;

constexpr double kEdgeShare = 0.02;                            // of the bone's size
constexpr double kShortestEdge = 0.001, kLongestEdge = 0.004;  // m
constexpr double kCoarse = 1.2, kFine = 0.7;  // times that edge: what is refined or simplified

// With the triangles turned alike and the holes closed.
Mesh closed(const TriMesh& mesh) {
  std::vector<Kernel::Point_3> points;
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    points.emplace_back(mesh.V(i, 0), mesh.V(i, 1), mesh.V(i, 2));
  std::vector<std::vector<std::size_t>> faces;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    faces.push_back(
        {std::size_t(mesh.F(f, 0)), std::size_t(mesh.F(f, 1)), std::size_t(mesh.F(f, 2))});
  pmp::repair_polygon_soup(points, faces);
  pmp::orient_polygon_soup(points, faces);
  Mesh out;
  pmp::polygon_soup_to_polygon_mesh(points, faces, out);
  pmp::stitch_borders(out);
  std::vector<Mesh::Halfedge_index> holes;
  pmp::extract_boundary_cycles(out, std::back_inserter(holes));
  for (const Mesh::Halfedge_index hole : holes)
    pmp::triangulate_hole(out, hole, CGAL::Emptyset_iterator());
  if (CGAL::is_closed(out)) pmp::orient_to_bound_a_volume(out);
  out.collect_garbage();
  return out;
}

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using HalfEdges = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;

// Four triangles for one. Precondition: a manifold.
TriMesh refined(const TriMesh& mesh) {
  HalfEdges work;
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    work.add_vertex({mesh.V(i, 0), mesh.V(i, 1), mesh.V(i, 2)});
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const auto corner = [&](int k) { return HalfEdges::VertexHandle(mesh.F(f, k)); };
    work.add_face(corner(0), corner(1), corner(2));
  }
  OpenMesh::Subdivider::Uniform::ModifiedButterflyT<HalfEdges, double> butterfly;
  butterfly.attach(work);
  butterfly(1);
  butterfly.detach();
  TriMesh out{Points(work.n_vertices(), 3), Triangles(work.n_faces(), 3)};
  for (const auto v : work.vertices()) {
    const HalfEdges::Point p = work.point(v);
    out.V.row(v.idx()) << p[0], p[1], p[2];
  }
  for (const auto f : work.faces()) {
    int k = 0;
    for (const auto v : work.fv_range(f)) out.F(f.idx(), k++) = v.idx();
  }
  return out;
}

double median_edge(const TriMesh& mesh) {
  std::vector<double> lengths;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      lengths.push_back((mesh.V.row(mesh.F(f, k)) - mesh.V.row(mesh.F(f, (k + 1) % 3))).norm());
  const auto middle = lengths.begin() + std::ptrdiff_t(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

// What edges are wanted to be long.
double wanted_edge(const TriMesh& mesh) {
  const double size = (mesh.V.colwise().maxCoeff() - mesh.V.colwise().minCoeff()).norm();
  return std::clamp(kEdgeShare * size, kShortestEdge, kLongestEdge);
}

}  // namespace

TriMesh closed_bone(const TriMesh& mesh) {
  TriMesh out = tri_mesh_of(closed(mesh));
  const double edge = wanted_edge(out), triangle = std::sqrt(3.0) / 4 * edge * edge;
  if (median_edge(out) > kFine * edge) return out;
  return simplify(out, int(std::ceil(mesh_area(out) / triangle)));
}

TriMesh rounded_bone(const TriMesh& mesh) {
  return median_edge(mesh) > kCoarse * wanted_edge(mesh) ? refined(mesh) : mesh;
}

}  // namespace ecorche::inline v1
