// Girths, breadths and depths: the loop of a plane's cut, its length or its hull's, and its
// derivative.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "morph/measures/measure_plane.h"

namespace ecorche {
namespace {

double cross2(const Vec2& o, const Vec2& a, const Vec2& b) {
  return (a - o).x() * (b - o).y() - (a - o).y() * (b - o).x();
}

}  // namespace

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

TapeMeasure::Plane TapeMeasure::make_plane(const Measure& m, const Points& V) const {
  const auto corner = [&](std::size_t k) -> Vec3 { return V.row(m.vertices[k]); };
  Plane plane;
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

void TapeMeasure::plane_gradient(const Measure& m, const Points& V, const Plane& plane,
                                 const Vec3& by_origin, const Vec3& by_normal,
                                 MeasureGradient& out) const {
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

// A vertex on the plane counts as above it, so every triangle is crossed by no edge or by two.
void TapeMeasure::cut(const std::vector<int>& starts, const Points& V, const Vec3& origin,
                      const Vec3& normal, const Vec3& near, std::vector<Crossing>& loop) const {
  loop.clear();
  const auto height = [&](int vertex) { return (V.row(vertex).transpose() - origin).dot(normal); };
  const auto corner = [&](int f, int e) { return triangles_(f, e % 3); };
  int first = -1;
  double best = std::numeric_limits<double>::max();
  for (int f : starts) {
    const bool up0 = height(triangles_(f, 0)) >= 0, up1 = height(triangles_(f, 1)) >= 0,
               up2 = height(triangles_(f, 2)) >= 0;
    if (up0 == up1 && up1 == up2) continue;
    for (int e = 0; e < 3; ++e) {
      const double distance = (V.row(triangles_(f, e)).transpose() - near).squaredNorm();
      if (distance < best) best = distance, first = f;
    }
  }
  if (first < 0) return;
  int f = first, entered = -1;
  const std::size_t limit = 4 * std::size_t(triangles_.rows());
  do {
    int leave = -1;
    for (int e = 0; e < 3; ++e) {
      const bool up = height(corner(f, e)) >= 0, next_up = height(corner(f, e + 1)) >= 0;
      // Without an edge it was entered by, leave over the one that falls: the loop then always runs
      // the same way round.
      if (up != next_up && e != entered && (entered >= 0 || up)) leave = e;
    }
    const int a = corner(f, leave), b = corner(f, leave + 1);
    const double ha = height(a), hb = height(b), t = ha / (ha - hb);
    loop.push_back({a, b, t, (1 - t) * V.row(a).transpose() + t * V.row(b).transpose()});
    const int next = neighbours_[f][leave];
    if (next < 0 || loop.size() > limit) break;
    for (int e = 0; e < 3; ++e)
      if (neighbours_[next][e] == f && corner(next, e) == b) entered = e;
    f = next;
  } while (f != first);
}

// The measure of the loop, and its derivative by the points of the loop where asked for.
double TapeMeasure::section(int k, const Points& V, double offset, std::vector<Crossing>& loop,
                            std::vector<Vec3>* by_crossing) const {
  const Measure& m = measure(k);
  const Plane plane = make_plane(m, V);
  const Vec3 origin = plane.origin + offset * plane.normal;
  cut(starts_[k], V, origin, plane.normal, origin, loop);
  if (m.arms_off) std::erase_if(loop, [this](const Crossing& c) { return arm_[c.a] || arm_[c.b]; });
  if (loop.size() < 3) return std::numeric_limits<double>::quiet_NaN();
  if (by_crossing != nullptr) by_crossing->assign(loop.size(), Vec3::Zero());
  if (m.kind != MeasureKind::girth) {
    const int axis = m.kind == MeasureKind::breadth ? 0 : 2;
    const auto less = [axis](const Crossing& x, const Crossing& y) {
      return x.point[axis] < y.point[axis];
    };
    const auto [low, high] = std::minmax_element(loop.begin(), loop.end(), less);
    if (by_crossing != nullptr) {
      (*by_crossing)[high - loop.begin()][axis] += 1;
      (*by_crossing)[low - loop.begin()][axis] -= 1;
    }
    return high->point[axis] - low->point[axis];
  }
  std::vector<int> corners(loop.size());
  std::iota(corners.begin(), corners.end(), 0);
  if (m.hull) {
    std::vector<Vec3> points;
    for (const Crossing& c : loop) points.push_back(c.point);
    corners = plane_hull(points, plane.normal);
  }
  double length = 0;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const std::size_t i = corners[c], j = corners[(c + 1) % corners.size()];
    const Vec3 d = loop[j].point - loop[i].point;
    const double step = d.norm();
    length += step;
    if (by_crossing == nullptr || step < 1e-12) continue;
    (*by_crossing)[i] -= d / step;
    (*by_crossing)[j] += d / step;
  }
  return length;
}

// The offset of the plane that makes the girth largest or smallest: a coarse look over the reach,
// then golden section.
double TapeMeasure::best_offset(int k, const Points& V) const {
  const Measure& m = measure(k);
  if (m.search == Search::none) return 0;
  std::vector<Crossing> loop;
  const double sign = m.search == Search::largest ? 1 : -1;
  const auto value = [&](double offset) {
    const double girth = sign * section(k, V, offset, loop, nullptr);
    return std::isfinite(girth) ? girth : -1e9;
  };
  constexpr int kSteps = 8;
  const double step = 2 * m.reach / kSteps;
  double best = -m.reach, best_value = value(best);
  for (int i = 1; i <= kSteps; ++i) {
    const double offset = -m.reach + i * step, v = value(offset);
    if (v > best_value) best = offset, best_value = v;
  }
  double low = std::max(best - step, -m.reach), high = std::min(best + step, m.reach);
  constexpr double kGolden = 0.6180339887498949;
  double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
  double at_left = value(left), at_right = value(right);
  while (high - low > 5e-4) {
    if (at_left > at_right) {
      high = right, right = left, at_right = at_left;
      left = high - kGolden * (high - low), at_left = value(left);
    } else {
      low = left, left = right, at_left = at_right;
      right = low + kGolden * (high - low), at_right = value(right);
    }
  }
  const double refined = at_left > at_right ? left : right;
  return std::max(at_left, at_right) > best_value ? refined : best;
}

double TapeMeasure::take_section(int k, const Points& V, MeasureGradient* gradient,
                                 TapeTrace* trace) const {
  const Measure& m = measure(k);
  std::vector<Crossing> loop;
  std::vector<Vec3> by_crossing;
  // The best offset does not move with the skin to first order where it lies inside the reach
  // (envelope theorem).
  const double offset = best_offset(k, V);
  const double value = section(k, V, offset, loop, gradient != nullptr ? &by_crossing : nullptr);
  if (!std::isfinite(value)) return value;
  const Plane plane = make_plane(m, V);
  if (gradient != nullptr) {
    const Vec3 origin = plane.origin + offset * plane.normal;
    Vec3 by_origin = Vec3::Zero(), by_normal = Vec3::Zero();
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Crossing& c = loop[i];
      if (by_crossing[i].isZero(0)) continue;
      const Vec3 e = V.row(c.b) - V.row(c.a);
      const double slope = by_crossing[i].dot(e) / plane.normal.dot(e);
      const Vec3 g = by_crossing[i] - slope * plane.normal;
      gradient->emplace_back(c.a, (1 - c.t) * g);
      gradient->emplace_back(c.b, c.t * g);
      by_origin += slope * plane.normal;
      by_normal -= slope * (c.point - origin);
    }
    by_normal += offset * by_origin;
    plane_gradient(m, V, plane, by_origin, by_normal, *gradient);
  }
  if (trace != nullptr) {
    std::vector<Vec3> line;
    for (const Crossing& c : loop) line.push_back(c.point);
    if (m.hull && m.kind == MeasureKind::girth) {
      std::vector<Vec3> bridged;
      for (int i : plane_hull(line, plane.normal)) bridged.push_back(line[i]);
      line = std::move(bridged);
    }
    line.push_back(line.front());
    trace->push_back(std::move(line));
  }
  return value;
}

}  // namespace ecorche
