#include "anatomy/geometry/subdivide.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using HalfEdges = OpenMesh::TriMesh_ArrayKernelT<>;

// The connectivity only: positions stay outside, because it is weights that are subdivided.
HalfEdges half_edges(const Triangles& F, int vertex_count) {
  omerr().disable();  // what is wrong is thrown below, not printed
  HalfEdges mesh;
  mesh.reserve(vertex_count, std::size_t(F.rows()) * 3 / 2 + 3, std::size_t(F.rows()));
  for (int i = 0; i < vertex_count; ++i) mesh.add_vertex(HalfEdges::Point(0, 0, 0));
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    const auto vertex = [&](int k) { return HalfEdges::VertexHandle(F(f, k)); };
    if (!mesh.add_face(vertex(0), vertex(1), vertex(2)).is_valid()) {
      throw UnfitError(
          fmt::format("triangle {} meets others in more than an edge between two faces; only "
                      "manifold meshes can be refined",
                      f));
    }
  }
  return mesh;
}

struct Step {
  Matrix map;  // new vertices from old: the old ones relaxed, then one in the middle of each face
  Triangles F;
  // old face of each new triangle's first corner, where that is a face's middle; else of the
  // half-edge
  std::vector<int> parents;
};

// Kobbelt's weight of the neighbours' mean for a vertex of n neighbours.
double neighbour_share(int n) { return (4 - 2 * std::cos(2 * std::numbers::pi / n)) / 9; }

Matrix step_map(const HalfEdges& mesh) {
  const int vertices = int(mesh.n_vertices()), faces = int(mesh.n_faces());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(std::size_t(vertices) * 7 + std::size_t(faces) * 3);
  for (const auto v : mesh.vertices()) {
    const int n = mesh.valence(v);
    const double share = n == 0 || mesh.is_boundary(v) ? 0 : neighbour_share(n);
    entries.emplace_back(v.idx(), v.idx(), 1 - share);
    if (share == 0) continue;
    for (const auto u : mesh.vv_range(v)) entries.emplace_back(v.idx(), u.idx(), share / n);
  }
  for (const auto f : mesh.faces()) {
    for (const auto v : mesh.fv_range(f))
      entries.emplace_back(vertices + f.idx(), v.idx(), 1.0 / 3);
  }
  Matrix map(vertices + faces, vertices);
  map.setFromTriplets(entries.begin(), entries.end());
  return map;
}

// New triangles, one a half-edge a->b with a face: a, the middle of the face across, the middle of
// its own. Along a boundary the edge stays. `parents` gives the base triangle of each old face's
// corner.
Step step(const Triangles& F, int vertex_count, const std::vector<int>& parents, bool second,
          int face_vertices_from) {
  const HalfEdges mesh = half_edges(F, vertex_count);
  Step out;
  out.map = step_map(mesh);
  std::vector<int> triangles;
  for (const auto f : mesh.faces()) {
    for (const auto h : mesh.fh_range(f)) {
      const auto across = mesh.face_handle(mesh.opposite_halfedge_handle(h));
      const int a = mesh.from_vertex_handle(h).idx(), b = mesh.to_vertex_handle(h).idx(),
                middle = vertex_count + f.idx();
      if (across.is_valid()) {
        triangles.insert(triangles.end(), {a, vertex_count + across.idx(), middle});
      } else {
        triangles.insert(triangles.end(), {a, b, middle});
      }
      // After the first step every triangle straddles two base faces; after the second each lies in
      // one: that whose middle, made by the first step, is at the half-edge's beginning, or else at
      // its end, or else (a boundary edge) that of the face.
      const int first_middle = a >= face_vertices_from ? a : b >= face_vertices_from ? b : -1;
      const int parent = !second             ? f.idx()
                         : first_middle >= 0 ? first_middle - face_vertices_from
                                             : parents[f.idx()];
      out.parents.push_back(parent);
    }
  }
  out.F = Eigen::Map<const Triangles>(triangles.data(), Eigen::Index(triangles.size() / 3), 3);
  return out;
}

// Both steps of a round: map and triangles, with the triangle each new one lies in.
Step round_of(const Triangles& F, int vertex_count) {
  const Step one = step(F, vertex_count, {}, false, 0);
  Step two = step(one.F, int(one.map.rows()), one.parents, true, vertex_count);
  two.map = Matrix(two.map * one.map);
  return two;
}

}  // namespace

Refinement refine(const Triangles& F, int vertex_count, int rounds) {
  Refinement out;
  out.F = F;
  out.map.resize(vertex_count, vertex_count);
  out.map.setIdentity();
  for (int i = 0; i < vertex_count; ++i) out.base_rows.push_back(i);
  for (Eigen::Index f = 0; f < F.rows(); ++f) out.parents.push_back(int(f));
  for (int round = 0; round < rounds; ++round) {
    Step finer = round_of(out.F, int(out.map.rows()));
    out.map = Matrix(finer.map * out.map);
    for (int& parent : finer.parents) parent = out.parents[parent];
    out.parents = std::move(finer.parents);
    out.F = std::move(finer.F);
  }
  if (rounds == 0) return out;
  // Base vertices come first at every step, so the top rows T say where the scheme moves them.
  // Moving them against it beforehand by half as much keeps the volume: the vertices of the base
  // end a little inside, its faces a little outside.
  Matrix ahead(vertex_count, vertex_count);
  ahead.setIdentity();
  ahead = Matrix(1.5 * ahead - 0.5 * Matrix(out.map.topRows(vertex_count)));
  out.map = Matrix(out.map * ahead);
  out.map.makeCompressed();
  return out;
}

Points refine_points(const Refinement& refinement, const Points& base) {
  return refinement.map * base;
}

}  // namespace ecorche::inline v1
