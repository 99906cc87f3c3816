#include "morph/measures/measure_plane.h"

#include <algorithm>
#include <numeric>

namespace ecorche::inline v1 {
namespace {

double cross2(const Vec2& o, const Vec2& a, const Vec2& b) {
  return (a - o).x() * (b - o).y() - (a - o).y() * (b - o).x();
}

}  // namespace

MeasurePlane make_plane(const Measure& m, const Points& V) {
  const auto corner = [&](std::size_t k) -> Vec3 { return V.row(m.vertices[k]); };
  MeasurePlane plane;
  plane.origin = corner(0);
  Vec3 along = Vec3::UnitY();
  switch (m.plane) {
    case PlaneKind::horizontal:
      return plane;
    case PlaneKind::across:
      along = corner(2) - corner(1);
      break;
    case PlaneKind::midline:
      along = Vec3::UnitX().cross(corner(1) - corner(0));
      break;
    case PlaneKind::foot:
      along = Vec3::UnitY().cross(corner(1) - corner(0));
      break;
    case PlaneKind::hand: {
      const Vec3 e = corner(1) - corner(0), d = corner(2) - 0.5 * (corner(0) + corner(1));
      along = d - d.dot(e) / e.squaredNorm() * e;
      break;
    }
  }
  plane.length = along.norm();
  plane.normal = along / plane.length;
  return plane;
}

void add_plane_gradient(const Measure& m, const Points& V, const MeasurePlane& plane,
                        const Vec3& by_origin, const Vec3& by_normal, MeasureGradient& out) {
  out.emplace_back(m.vertices[0], by_origin);
  if (plane.length == 0) return;
  const Vec3 g = (by_normal - plane.normal * plane.normal.dot(by_normal)) / plane.length;
  const auto corner = [&](std::size_t k) -> Vec3 { return V.row(m.vertices[k]); };
  if (m.plane == PlaneKind::across) {
    out.emplace_back(m.vertices[2], g);
    out.emplace_back(m.vertices[1], -g);
  } else if (m.plane == PlaneKind::hand) {
    const Vec3 e = corner(1) - corner(0), d = corner(2) - 0.5 * (corner(0) + corner(1));
    const double ee = e.squaredNorm(), s = d.dot(e) / ee, ge = g.dot(e);
    const Vec3 by_d = g - e * (ge / ee), by_e = -s * g - ge * (d - 2 * s * e) / ee;
    out.emplace_back(m.vertices[2], by_d);
    out.emplace_back(m.vertices[1], by_e - 0.5 * by_d);
    out.emplace_back(m.vertices[0], -by_e - 0.5 * by_d);
  } else {
    const Vec3 axis = m.plane == PlaneKind::midline ? Vec3::UnitX() : Vec3::UnitY();
    const Vec3 by_e = g.cross(axis);
    out.emplace_back(m.vertices[1], by_e);
    out.emplace_back(m.vertices[0], -by_e);
  }
}

// Andrew's monotone chain, 1979.
std::vector<int> plane_hull(const std::vector<Vec3>& points, const Vec3& normal) {
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<Vec2> p;
  for (const Vec3& x : points) p.emplace_back(x.dot(u), x.dot(v));
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto at = [&p](int i) -> const Vec2& { return p[i]; };
  std::sort(order.begin(), order.end(), [&](int i, int j) {
    return std::make_pair(at(i).x(), at(i).y()) < std::make_pair(at(j).x(), at(j).y());
  });
  std::vector<int> hull;
  const auto add = [&](int i, std::size_t least) {
    while (hull.size() >= least && cross2(at(hull[hull.size() - 2]), at(hull.back()), at(i)) <= 0)
      hull.pop_back();
    hull.push_back(i);
  };
  for (int i : order) add(i, 2);
  const std::size_t lower = hull.size() + 1;
  for (auto i = order.rbegin() + 1; i < order.rend(); ++i) add(*i, lower);
  if (hull.size() > 1) hull.pop_back();
  return hull;
}

std::vector<int> bridged_chain(const std::vector<Vec3>& points) {
  // which side the chain bulges to, by the area between it and the straight line
  double outward = 0;
  const auto flat = [&points](int i) { return Vec2(points[i].y(), points[i].z()); };
  const int n = points.size();
  for (int i = 1; i + 1 < n; ++i) outward += cross2(flat(0), flat(i), flat(i + 1));
  std::vector<int> kept;
  for (int i = 0; i < n; ++i) {
    while (kept.size() >= 2 &&
           outward * cross2(flat(kept[kept.size() - 2]), flat(kept.back()), flat(i)) <= 0)
      kept.pop_back();
    kept.push_back(i);
  }
  return kept;
}

}  // namespace ecorche::inline v1
