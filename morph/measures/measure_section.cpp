#include "morph/measures/measure_section.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace ecorche::inline v1 {
namespace {

// m: the golden section search ends here; larger, and the largest or smallest girth is off by more.
constexpr double kOffsetTolerance = 5e-4;

// The measure of the loop, and its derivative by the points of the loop where asked for.
double section(const SectionMesh& mesh, const Measure& m, const std::vector<int>& starts,
               const Points& V, double offset, std::vector<SkinCrossing>& loop,
               std::vector<Vec3>* by_crossing) {
  const MeasurePlane plane = make_plane(m, V);
  const Vec3 origin = plane.origin + offset * plane.normal;
  cut_loop(mesh, starts, V, origin, plane.normal, origin, loop);
  if (m.arms_off)
    std::erase_if(loop, [&](const SkinCrossing& c) { return mesh.arm[c.a] || mesh.arm[c.b]; });
  if (loop.size() < 3) return std::numeric_limits<double>::quiet_NaN();
  if (by_crossing != nullptr) by_crossing->assign(loop.size(), Vec3::Zero());
  if (m.kind != MeasureKind::girth) {
    const int axis = m.kind == MeasureKind::breadth ? 0 : 2;
    const auto less = [axis](const SkinCrossing& x, const SkinCrossing& y) {
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
    for (const SkinCrossing& c : loop) points.push_back(c.point);
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
double best_offset(const SectionMesh& mesh, const Measure& m, const std::vector<int>& starts,
                   const Points& V) {
  if (m.search == Search::none) return 0;
  std::vector<SkinCrossing> loop;
  const double sign = m.search == Search::largest ? 1 : -1;
  const auto value = [&](double offset) {
    const double girth = sign * section(mesh, m, starts, V, offset, loop, nullptr);
    return std::isfinite(girth) ? girth : -1e9;
  };
  constexpr int kSteps = 8;  // of the coarse look; fewer may miss the extremum
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
  while (high - low > kOffsetTolerance) {
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

}  // namespace

SectionMesh make_section_mesh(const Triangles& triangles) {
  SectionMesh mesh;
  mesh.triangles = triangles;
  std::map<std::pair<int, int>, std::pair<int, int>> owner;  // directed edge -> triangle, edge
  mesh.neighbours.assign(std::size_t(triangles.rows()), {-1, -1, -1});
  for (int f = 0; f < triangles.rows(); ++f)
    for (int e = 0; e < 3; ++e) owner[{triangles(f, e), triangles(f, (e + 1) % 3)}] = {f, e};
  for (const auto& [edge, from] : owner) {
    const auto other = owner.find({edge.second, edge.first});
    if (other != owner.end()) mesh.neighbours[from.first][from.second] = other->second.first;
  }
  return mesh;
}

// A vertex on the plane counts as above it, so every triangle is crossed by no edge or by two.
void cut_loop(const SectionMesh& mesh, const std::vector<int>& starts, const Points& V,
              const Vec3& origin, const Vec3& normal, const Vec3& near,
              std::vector<SkinCrossing>& loop) {
  loop.clear();
  const auto height = [&](int vertex) { return (V.row(vertex).transpose() - origin).dot(normal); };
  const auto corner = [&](int f, int e) { return mesh.triangles(f, e % 3); };
  int first = -1;
  double best = std::numeric_limits<double>::max();
  for (int f : starts) {
    const bool up0 = height(mesh.triangles(f, 0)) >= 0, up1 = height(mesh.triangles(f, 1)) >= 0,
               up2 = height(mesh.triangles(f, 2)) >= 0;
    if (up0 == up1 && up1 == up2) continue;
    for (int e = 0; e < 3; ++e) {
      const double distance = (V.row(mesh.triangles(f, e)).transpose() - near).squaredNorm();
      if (distance < best) best = distance, first = f;
    }
  }
  if (first < 0) return;
  int f = first, entered = -1;
  const std::size_t limit = 4 * std::size_t(mesh.triangles.rows());
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
    const int next = mesh.neighbours[f][leave];
    if (next < 0 || loop.size() > limit) break;
    for (int e = 0; e < 3; ++e)
      if (mesh.neighbours[next][e] == f && corner(next, e) == b) entered = e;
    f = next;
  } while (f != first);
}

double take_section(const SectionMesh& mesh, const Measure& m, const std::vector<int>& starts,
                    const Points& V, MeasureGradient* gradient, TapeTrace* trace) {
  std::vector<SkinCrossing> loop;
  std::vector<Vec3> by_crossing;
  // The best offset does not move with the skin to first order where it lies inside the reach
  // (envelope theorem).
  const double offset = best_offset(mesh, m, starts, V);
  const double value =
      section(mesh, m, starts, V, offset, loop, gradient != nullptr ? &by_crossing : nullptr);
  if (!std::isfinite(value)) return value;
  const MeasurePlane plane = make_plane(m, V);
  if (gradient != nullptr) {
    const Vec3 origin = plane.origin + offset * plane.normal;
    Vec3 by_origin = Vec3::Zero(), by_normal = Vec3::Zero();
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const SkinCrossing& c = loop[i];
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
    add_plane_gradient(m, V, plane, by_origin, by_normal, *gradient);
  }
  if (trace != nullptr) {
    std::vector<Vec3> line;
    for (const SkinCrossing& c : loop) line.push_back(c.point);
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

}  // namespace ecorche::inline v1
