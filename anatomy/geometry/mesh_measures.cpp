#include "anatomy/geometry/mesh_measures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace ecorche::inline v1 {
namespace {

struct Corners {
  Vec3 a, b, c;
};

Corners corners(const TriMesh& mesh, Eigen::Index f) {
  return {mesh.V.row(mesh.F(f, 0)), mesh.V.row(mesh.F(f, 1)), mesh.V.row(mesh.F(f, 2))};
}

// Distance from a point to a triangle: inside the face or on the nearest edge.
double distance_to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const double area = n.norm();
  const auto to_edge = [&](const Vec3& u, const Vec3& v) {
    const Vec3 e = v - u;
    const double t =
        e.squaredNorm() > 0 ? std::clamp((p - u).dot(e) / e.squaredNorm(), 0.0, 1.0) : 0;
    return (p - u - t * e).norm();
  };
  const bool inside = area > 0 && n.dot((b - a).cross(p - a)) >= 0 &&
                      n.dot((c - b).cross(p - b)) >= 0 && n.dot((a - c).cross(p - c)) >= 0;
  return inside ? std::abs(n.dot(p - a)) / area
                : std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

}  // namespace

double distance_to_mesh(const Vec3& p, const TriMesh& mesh) {
  double nearest = std::numeric_limits<double>::infinity();
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    nearest =
        std::min(nearest, distance_to_triangle(p, mesh.V.row(mesh.F(f, 0)),
                                               mesh.V.row(mesh.F(f, 1)), mesh.V.row(mesh.F(f, 2))));
  return nearest;
}

double mesh_volume(const TriMesh& mesh) {
  if (mesh.F.rows() == 0) return 0;
  const Vec3 origin = mesh.V.row(mesh.F(0, 0));  // near the mesh: far ones keep their precision
  double six_volumes = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const auto [a, b, c] = corners(mesh, f);
    six_volumes += (a - origin).dot((b - origin).cross(c - origin));
  }
  return six_volumes / 6;
}

double mesh_area(const TriMesh& mesh) {
  double twice = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const auto [a, b, c] = corners(mesh, f);
    twice += (b - a).cross(c - a).norm();
  }
  return twice / 2;
}

Points vertex_normals(const TriMesh& mesh) {
  Points normals = Points::Zero(mesh.V.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const auto [a, b, c] = corners(mesh, f);
    const Vec3 n = (b - a).cross(c - a);
    for (int k = 0; k < 3; ++k) normals.row(mesh.F(f, k)) += n.transpose();
  }
  for (Eigen::Index i = 0; i < normals.rows(); ++i) {
    const double length = normals.row(i).norm();
    if (length > 0) normals.row(i) /= length;
  }
  return normals;
}

bool is_closed(const Triangles& F) {
  std::vector<std::pair<int, int>> edges;
  edges.reserve(F.size());
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) edges.emplace_back(F(f, k), F(f, (k + 1) % 3));
  }
  std::sort(edges.begin(), edges.end());
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) return false;
  return std::all_of(edges.begin(), edges.end(), [&](const auto& e) {
    return e.first != e.second &&
           std::binary_search(edges.begin(), edges.end(), std::pair(e.second, e.first));
  });
}

std::vector<double> vertex_areas(const TriMesh& mesh) {
  std::vector<double> areas(mesh.V.rows(), 0.0);
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
               c = mesh.V.row(mesh.F(f, 2));
    for (int i = 0; i < 3; ++i) areas[mesh.F(f, i)] += (b - a).cross(c - a).norm() / 6;
  }
  return areas;
}

}  // namespace ecorche::inline v1
