#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/mesh_formats.h"

namespace ecorche {
namespace {

constexpr std::size_t kPolygonLimit = 10000;

Vec3 newell_normal(const Points& V, const std::vector<int>& polygon) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3 a = V.row(polygon[k]) - V.row(polygon[0]), b = V.row(polygon[(k + 1) % polygon.size()]) - V.row(polygon[0]);
    sum += a.cross(b);
  }
  return sum;
}

// A polygon flattened along its mean normal.
std::vector<Vec2> flatten(const Points& V, const std::vector<int>& polygon) {
  const Vec3 normal = newell_normal(V, polygon);
  const Vec3 n = normal.norm() > 0 ? Vec3(normal.normalized()) : Vec3::UnitZ();
  const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
  std::vector<Vec2> out;
  for (int i : polygon) {
    const Vec3 p = V.row(i) - V.row(polygon[0]);
    out.emplace_back(p.dot(u), p.dot(v));
  }
  return out;
}

double twice_area(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

bool inside(const Vec2& p, const Vec2& a, const Vec2& b, const Vec2& c) {
  return twice_area(a, b, p) >= 0 && twice_area(b, c, p) >= 0 && twice_area(c, a, p) >= 0;
}

// Ears of a ring of corners; where none is left to find (a crossing polygon), the corner that turns least wrong is cut.
void clip_ears(const Points& V, const std::vector<int>& polygon, std::vector<int>& out) {
  const std::vector<Vec2> flat = flatten(V, polygon);
  std::vector<int> ring(polygon.size());
  for (std::size_t k = 0; k < ring.size(); ++k) ring[k] = static_cast<int>(k);
  const auto at = [&](std::size_t k) -> const Vec2& { return flat[static_cast<std::size_t>(ring[k % ring.size()])]; };
  while (ring.size() > 3) {
    const std::size_t n = ring.size();
    std::size_t best = 0;
    double best_score = -1e300;
    for (std::size_t k = 0; k < n; ++k) {
      const Vec2 &a = at(k + n - 1), &b = at(k), &c = at(k + 1);
      const double area = twice_area(a, b, c);
      bool empty = area > 0;
      for (std::size_t m = k + 2; empty && m < k + n - 1; ++m) {
        const Vec2& p = at(m);
        empty = p == a || p == b || p == c || !inside(p, a, b, c);
      }
      // Round ears first: slivers are what makes a bad triangulation.
      const double edges = (a - b).squaredNorm() + (b - c).squaredNorm() + (c - a).squaredNorm();
      const double score = (empty ? 10 : 0) + (edges > 0 ? area / edges : 0);
      if (score > best_score) best = k, best_score = score;
    }
    for (const std::size_t k : {best + n - 1, best, best + 1}) out.push_back(polygon[static_cast<std::size_t>(ring[k % n])]);
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(best));
  }
  for (int k : ring) out.push_back(polygon[static_cast<std::size_t>(k)]);
}

void append_triangles(const Points& V, const std::vector<int>& polygon, std::vector<int>& out) {
  if (polygon.size() == 3) {
    out.insert(out.end(), polygon.begin(), polygon.end());
  } else if (polygon.size() == 4) {
    const Vec3 n = newell_normal(V, polygon);
    const auto fits = [&](int a, int b, int c) {
      const Vec3 p = V.row(polygon[static_cast<std::size_t>(a)]), q = V.row(polygon[static_cast<std::size_t>(b)]), r = V.row(polygon[static_cast<std::size_t>(c)]);
      return n.dot((q - p).cross(r - p));
    };
    const double first_fit = std::min(fits(0, 1, 2), fits(0, 2, 3));
    const bool first = first_fit > 0 || first_fit >= std::min(fits(1, 2, 3), fits(1, 3, 0));
    constexpr std::size_t kOrders[2][6] = {{1, 2, 3, 1, 3, 0}, {0, 1, 2, 0, 2, 3}};
    for (std::size_t k : kOrders[first]) out.push_back(polygon[k]);
  } else {
    clip_ears(V, polygon, out);
  }
}

}  // namespace

TriMesh triangulate(const Polygons& polygons, const std::string& name, std::vector<std::string>& notes) {
  TriMesh mesh;
  mesh.V = Eigen::Map<const Points>(polygons.coordinates.data(), static_cast<Eigen::Index>(polygons.coordinates.size() / 3), 3);
  std::vector<int> triangles, polygon;
  triangles.reserve(polygons.corners.size());
  std::size_t next = 0;
  int dropped = 0;
  for (std::size_t f = 0; f < polygons.sizes.size(); ++f) {
    polygon.clear();
    const auto size = static_cast<std::size_t>(polygons.sizes[f]);
    for (std::size_t k = 0; k < size; ++k) {
      const int corner = polygons.corners[next + k];
      if (polygon.empty() || polygon.back() != corner) polygon.push_back(corner);
    }
    next += size;
    while (polygon.size() > 1 && polygon.front() == polygon.back()) polygon.pop_back();
    if (polygon.size() < 3) {
      ++dropped;
      continue;
    }
    if (polygon.size() > kPolygonLimit) {
      throw LimitError(fmt::format("{}: face {} has {} corners; the limit is {}", name, f + 1, polygon.size(), kPolygonLimit));
    }
    append_triangles(mesh.V, polygon, triangles);
  }
  if (dropped > 0) notes.push_back(fmt::format("{}: passed over {} faces with fewer than three different corners", name, dropped));
  if (triangles.empty()) throw UnfitError(fmt::format("{}: {} vertices but no faces; a surface is needed", name, mesh.V.rows()));
  if (static_cast<long long>(triangles.size()) / 3 > kMeshLimit) throw LimitError(fmt::format("{}: more than {} triangles", name, kMeshLimit));
  mesh.F = Eigen::Map<const Triangles>(triangles.data(), static_cast<Eigen::Index>(triangles.size() / 3), 3);
  return mesh;
}

}  // namespace ecorche
