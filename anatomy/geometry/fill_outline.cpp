#include "anatomy/geometry/fill_outline.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ecorche::inline v1 {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
constexpr int kNew = -1;      // a vertex where segments cross
constexpr int kNowhere = -1;  // a face whose region is not known yet

struct VertexNumber {
  int value = kNew;
};
struct FaceRegion {
  int value = kNowhere;
};
using Vertices = CGAL::Triangulation_vertex_base_with_info_2<VertexNumber, Kernel>;
using Faces = CGAL::Constrained_triangulation_face_base_2<
    Kernel, CGAL::Triangulation_face_base_with_info_2<FaceRegion, Kernel>>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<Vertices, Faces>, CGAL::Exact_predicates_tag>;
using Face = Triangulation::Face_handle;
using Segment = std::array<int, 2>;

// The segments, and those that lead from where one ends without a next to where one begins.
std::vector<Segment> closed(std::span<const Vec2> points, std::span<const Segment> segments) {
  std::vector<int> more_ends(points.size(), 0);
  for (const auto& [from, to] : segments)
    --more_ends[std::size_t(from)], ++more_ends[std::size_t(to)];
  std::vector<int> begins;
  for (int i = 0; i < int(points.size()); ++i)
    for (int k = more_ends[std::size_t(i)]; k < 0; ++k) begins.push_back(i);
  std::vector<Segment> out(segments.begin(), segments.end());
  for (int i = 0; i < int(points.size()); ++i) {
    for (int k = more_ends[std::size_t(i)]; k > 0 && !begins.empty(); --k) {
      const auto nearest = std::ranges::min_element(begins, {}, [&](int b) {
        return (points[std::size_t(b)] - points[std::size_t(i)]).squaredNorm();
      });
      out.push_back({i, *nearest});
      begins.erase(nearest);
    }
  }
  return out;
}

// Faces that hang together without a segment between them get the same number.
int mark_regions(Triangulation& triangulation) {
  int regions = 0;
  std::vector<Face> open;
  for (const Face begin : triangulation.finite_face_handles()) {
    if (begin->info().value != kNowhere) continue;
    begin->info().value = regions;
    open.assign(1, begin);
    while (!open.empty()) {
      const Face face = open.back();
      open.pop_back();
      for (int k = 0; k < 3; ++k) {
        const Face beside = face->neighbor(k);
        if (face->is_constrained(k) || triangulation.is_infinite(beside) ||
            beside->info().value != kNowhere)
          continue;
        beside->info().value = regions;
        open.push_back(beside);
      }
    }
    ++regions;
  }
  return regions;
}

Vec2 vec_of_point(const Kernel::Point_2& p) { return {p.x(), p.y()}; }
Vec2 center_of(const Face& face) {
  return (vec_of_point(face->vertex(0)->point()) + vec_of_point(face->vertex(1)->point()) +
          vec_of_point(face->vertex(2)->point())) /
         3;
}

double winding(std::span<const Vec2> points, std::span<const Segment> segments, const Vec2& at) {
  double angle = 0;
  for (const auto& [from, to] : segments) {
    const Vec2 a = points[std::size_t(from)] - at, b = points[std::size_t(to)] - at;
    angle += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  }
  return angle / (2 * std::numbers::pi);
}

// Whether the region is inside, by its largest face.
std::vector<char> inside_regions(const Triangulation& triangulation, int regions,
                                 std::span<const Vec2> points, std::span<const Segment> segments) {
  std::vector<double> largest(std::size_t(regions), -1);
  std::vector<Face> at(static_cast<std::size_t>(regions));
  for (const Face face : triangulation.finite_face_handles()) {
    const std::size_t region = std::size_t(face->info().value);
    const double area = triangulation.triangle(face).area();
    if (area > largest[region]) largest[region] = area, at[region] = face;
  }
  std::vector<char> out;
  for (const Face& face : at)
    out.push_back(std::abs(winding(points, segments, center_of(face))) > 0.5);
  return out;
}

}  // namespace

FilledOutline fill_outline(std::span<const Vec2> points, std::span<const Segment> segments) {
  FilledOutline out;
  out.points.assign(points.begin(), points.end());
  if (segments.size() < 2) return out;
  const std::vector<Segment> loops = closed(points, segments);
  Triangulation triangulation;
  std::vector<Triangulation::Vertex_handle> handles;
  for (int i = 0; i < int(points.size()); ++i) {
    const Vec2& p = points[std::size_t(i)];
    const auto handle = triangulation.insert({p.x(), p.y()});
    if (handle->info().value == kNew) handle->info().value = i;
    handles.push_back(handle);
  }
  for (const auto& [from, to] : loops)
    if (handles[std::size_t(from)] != handles[std::size_t(to)])
      triangulation.insert_constraint(handles[std::size_t(from)], handles[std::size_t(to)]);
  const int regions = mark_regions(triangulation);
  const std::vector<char> inside = inside_regions(triangulation, regions, points, loops);
  for (const Face face : triangulation.finite_face_handles()) {
    if (!inside[std::size_t(face->info().value)]) continue;
    std::array<int, 3> corners{};
    for (int k = 0; k < 3; ++k) {
      const auto vertex = face->vertex(k);
      if (vertex->info().value == kNew) {
        vertex->info().value = int(out.points.size());
        out.points.push_back(vec_of_point(vertex->point()));
      }
      corners[std::size_t(k)] = vertex->info().value;
    }
    out.triangles.push_back(corners);
  }
  return out;
}

}  // namespace ecorche::inline v1
