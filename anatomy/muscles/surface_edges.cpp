#include "anatomy/muscles/surface_edges.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <unordered_map>
#include <utility>

#include "anatomy/compute/angle_between.h"

namespace ecorche::inline v1 {
namespace {

Vec3 face_normal(const Points& V, const Triangles& F, int f) {
  const Vec3 a = V.row(F(f, 0)), b = V.row(F(f, 1)), c = V.row(F(f, 2));
  return (b - a).cross(c - a);
}

}  // namespace

SurfaceEdge edge_at(const SurfaceEdge& edge, const MuscleSurface& surface,
                    const Points& positions) {
  SurfaceEdge out = edge;
  out.length = (positions.row(edge.begin) - positions.row(edge.end)).norm();
  out.turn = angle_between(face_normal(positions, surface.F, edge.left),
                           face_normal(positions, surface.F, edge.right));
  return out;
}

std::vector<SurfaceEdge> inner_edges(const MuscleSurface& surface, const Points& positions) {
  std::vector<std::vector<SurfaceEdge>> found(surface.parts.size());
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t p) {
    const MuscleSurface::Part& part = surface.parts[p];
    std::unordered_map<long long, int> sides;
    for (int f = part.face_begin; f < part.face_end; ++f)
      for (int k = 0; k < 3; ++k) {
        const int a = surface.F(f, k), b = surface.F(f, (k + 1) % 3);
        const auto key = [](long long from, long long to) { return from << 32 | to; };
        const auto other = sides.find(key(b, a));
        if (other == sides.end())
          sides[key(a, b)] = f;
        else
          found[p].push_back(
              edge_at({part.muscle, a, b, f, other->second, 0, 0}, surface, positions));
      }
  });
  std::vector<SurfaceEdge> out;
  for (const std::vector<SurfaceEdge>& edges : found)
    out.insert(out.end(), edges.begin(), edges.end());
  return out;
}

Standing standing_off(const MuscleSurface& surface, std::span<const SurfaceEdge> edges,
                      const Points& positions) {
  const std::size_t vertices = surface.vertices();
  std::vector<Vec3> sum(vertices, Vec3::Zero()), normals(vertices, Vec3::Zero());
  std::vector<int> count(vertices, 0);
  for (const SurfaceEdge& edge : edges)
    for (const auto& [own, other] :
         {std::pair(edge.begin, edge.end), std::pair(edge.end, edge.begin)}) {
      sum[own] += positions.row(other).transpose();
      ++count[own];
    }
  for (int f = 0; f < int(surface.F.rows()); ++f) {
    if (count[std::size_t(surface.F(f, 0))] == 0) continue;
    const Vec3 normal = face_normal(positions, surface.F, f);
    for (int k = 0; k < 3; ++k) normals[surface.F(f, k)] += normal;
  }
  Standing out{std::vector<double>(vertices, 0.0), std::vector<double>(vertices, 0.0)};
  for (std::size_t v = 0; v < vertices; ++v) {
    if (count[v] == 0) continue;
    const Vec3 offset = positions.row(v).transpose() - sum[v] / count[v];
    out.off[v] = offset.norm();
    out.out[v] = offset.dot(normals[v].normalized());
  }
  return out;
}

}  // namespace ecorche::inline v1
