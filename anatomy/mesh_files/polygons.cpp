#include "anatomy/mesh_files/polygons.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/limits.h"

namespace ecorche::inline v1 {
namespace {

Vec3 newell_normal(const Points& V, const std::vector<int>& polygon) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3 a = V.row(polygon[k]) - V.row(polygon[0]),
               b = V.row(polygon[(k + 1) % polygon.size()]) - V.row(polygon[0]);
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

// A ring of corners from which ears are cut. What is known of a corner stays so until a neighbour
// of it goes or the one corner that was found to lie within its triangle, so that a polygon takes
// time by the square of its corners, not by their cube.
class EarRing {
 public:
  EarRing(std::vector<Vec2> flat) : flat_(std::move(flat)), corners_(flat_.size()) {
    const std::size_t n = flat_.size();
    for (std::size_t k = 0; k < n; ++k)
      corners_[k] = {(k + n - 1) % n, (k + 1) % n, (k + 2) % n, 0, true};
    for (std::size_t k = 0; k < n; ++k) judge(k);
  }

  // The corner whose ear is cut next: where none is left to find (a crossing polygon), the one that
  // turns least wrong.
  std::size_t best() const {
    std::size_t found = first_;
    for (std::size_t k = corners_[first_].next; k != first_; k = corners_[k].next)
      if (corners_[k].score > corners_[found].score) found = k;
    return found;
  }
  std::size_t before(std::size_t k) const { return corners_[k].before; }
  std::size_t next(std::size_t k) const { return corners_[k].next; }
  std::size_t first() const { return first_; }

  void cut(std::size_t k) {
    const std::size_t a = corners_[k].before, c = corners_[k].next;
    corners_[k].there = false;
    corners_[a].next = c;
    corners_[c].before = a;
    if (first_ == k) first_ = c;
    for (std::size_t m = corners_[c].next; m != a; m = corners_[m].next)
      if (corners_[m].within == k) judge(m);
    for (const std::size_t m : {a, c}) {
      corners_[m].within = corners_[corners_[m].next].next;
      judge(m);
    }
  }

 private:
  struct Corner {
    std::size_t before = 0, next = 0;
    // no corner from the next but one up to this one lies within the triangle; this one does, or
    // there is none
    std::size_t within = 0;
    double score = 0;
    bool there = false;
  };

  void judge(std::size_t k) {
    Corner& corner = corners_[k];
    const Vec2 &a = flat_[corner.before], &b = flat_[k], &c = flat_[corner.next];
    const double area = twice_area(a, b, c);
    bool empty = area > 0;
    if (empty) {
      std::size_t m = corner.within;
      while (!corners_[m].there)
        m = corners_[m].next;  // those that went keep the way on from where they were
      while (m != corner.before && !blocks(flat_[m], a, b, c)) m = corners_[m].next;
      corner.within = m;
      empty = m == corner.before;
    }
    // Round ears first: slivers are what makes a bad triangulation.
    const double edges = (a - b).squaredNorm() + (b - c).squaredNorm() + (c - a).squaredNorm();
    corner.score = (empty ? 10 : 0) + (edges > 0 ? area / edges : 0);
  }

  static bool blocks(const Vec2& p, const Vec2& a, const Vec2& b, const Vec2& c) {
    return p != a && p != b && p != c && inside(p, a, b, c);
  }

  std::vector<Vec2> flat_;
  std::vector<Corner> corners_;
  std::size_t first_ = 0;
};

// Corners of triangles as places in the polygon.
void clip_ears(const Points& V, const std::vector<int>& polygon, std::vector<int>& out) {
  EarRing ring(flatten(V, polygon));
  for (std::size_t left = polygon.size(); left > 3; --left) {
    const std::size_t k = ring.best();
    for (const std::size_t corner : {ring.before(k), k, ring.next(k)}) out.push_back(int(corner));
    ring.cut(k);
  }
  for (const std::size_t corner :
       {ring.first(), ring.next(ring.first()), ring.before(ring.first())})
    out.push_back(int(corner));
}

void cut_polygon(const Points& V, const std::vector<int>& polygon, std::vector<int>& out) {
  out.clear();
  if (polygon.size() == 3) {
    out = {0, 1, 2};
  } else if (polygon.size() == 4) {
    const Vec3 n = newell_normal(V, polygon);
    const auto fits = [&](int a, int b, int c) {
      const Vec3 p = V.row(polygon[a]), q = V.row(polygon[b]), r = V.row(polygon[c]);
      return n.dot((q - p).cross(r - p));
    };
    const double first_fit = std::min(fits(0, 1, 2), fits(0, 2, 3));
    const bool first = first_fit > 0 || first_fit >= std::min(fits(1, 2, 3), fits(1, 3, 0));
    constexpr int kOrders[2][6] = {{1, 2, 3, 1, 3, 0}, {0, 1, 2, 0, 2, 3}};
    out.assign(kOrders[first], kOrders[first] + 6);
  } else {
    clip_ears(V, polygon, out);
  }
}

// The polygon without corners that repeat their neighbour; `places` of them in all corners.
void distinct_corners(const Polygons& polygons, std::size_t begin, std::size_t size,
                      std::vector<int>& polygon, std::vector<int>& places) {
  polygon.clear();
  places.clear();
  for (std::size_t k = begin; k < begin + size; ++k) {
    if (!polygon.empty() && polygon.back() == polygons.corners[k]) continue;
    polygon.push_back(polygons.corners[k]);
    places.push_back(int(k));
  }
  while (polygon.size() > 1 && polygon.front() == polygon.back()) {
    polygon.pop_back();
    places.pop_back();
  }
}

}  // namespace

TriMesh triangulate(const Polygons& polygons, const std::string& name,
                    std::vector<std::string>& notes, bool clouds, TriangleSources* sources) {
  TriMesh mesh;
  mesh.V = Eigen::Map<const Points>(polygons.coordinates.data(),
                                    Eigen::Index(polygons.coordinates.size() / 3), 3);
  if (clouds && polygons.sizes.empty() && mesh.V.rows() > 0) {
    mesh.F.resize(0, 3);
    return mesh;
  }
  std::vector<int> triangles, polygon, places, cut;
  triangles.reserve(polygons.corners.size());
  std::size_t next = 0, work = 0;
  int dropped = 0;
  for (std::size_t f = 0; f < polygons.sizes.size(); ++f) {
    const std::size_t size = polygons.sizes[f];
    distinct_corners(polygons, next, size, polygon, places);
    next += size;
    if (polygon.size() < 3) {
      ++dropped;
      continue;
    }
    if (polygon.size() > limits::kPolygonCorners) {
      throw LimitError(fmt::format("{}: face {} has {} corners; the limit is {}", name, f + 1,
                                   polygon.size(), limits::kPolygonCorners));
    }
    if (polygon.size() > 4) work += polygon.size() * polygon.size();
    if (work > limits::kPolygonWork)
      throw LimitError(
          fmt::format("{}: face {}: too many polygons of many corners; save the mesh in triangles",
                      name, f + 1));
    cut_polygon(mesh.V, polygon, cut);
    for (const int k : cut) triangles.push_back(polygon[k]);
    if (!sources) continue;
    for (const int k : cut) sources->corners.push_back(places[k]);
    sources->polygons.insert(sources->polygons.end(), cut.size() / 3, int(f));
  }
  if (dropped > 0)
    notes.push_back(fmt::format("{}: passed over {} faces with fewer than three different corners",
                                name, dropped));
  if (triangles.empty())
    throw UnfitError(
        fmt::format("{}: {} vertices but no faces; a surface is needed", name, mesh.V.rows()));
  if (static_cast<long long>(triangles.size()) / 3 > limits::kMeshElements)
    throw LimitError(fmt::format("{}: more than {} triangles", name, limits::kMeshElements));
  mesh.F = Eigen::Map<const Triangles>(triangles.data(), Eigen::Index(triangles.size() / 3), 3);
  return mesh;
}

}  // namespace ecorche::inline v1
