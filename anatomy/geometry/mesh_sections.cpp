#include "anatomy/geometry/mesh_sections.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangle = Kernel::Triangle_3;
using Iterator = std::vector<Triangle>::const_iterator;
using Tree =
    CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_triangle_primitive<Kernel, Iterator>>>;

Kernel::Point_3 point_of(const Vec3& p) { return {p.x(), p.y(), p.z()}; }
Kernel::Vector_3 vector_of(const Vec3& p) { return {p.x(), p.y(), p.z()}; }
Vec3 vec_of(const Kernel::Point_3& p) { return {p.x(), p.y(), p.z()}; }

struct Cut {
  int triangle = 0;
  Vec3 a, b;  // the segment in which the plane meets the triangle
};

Vec3 nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  const double length = d.squaredNorm();
  return length > 0 ? Vec3(a + std::clamp((p - a).dot(d) / length, 0.0, 1.0) * d) : a;
}

double segment_gap(const Cut& s, const Cut& t) {
  return std::min({(s.a - nearest_on_segment(s.a, t.a, t.b)).norm(),
                   (s.b - nearest_on_segment(s.b, t.a, t.b)).norm(),
                   (t.a - nearest_on_segment(t.a, s.a, s.b)).norm(),
                   (t.b - nearest_on_segment(t.b, s.a, s.b)).norm()});
}

// Which piece each cut belongs to: those closer than the gap to one of a piece are of it.
std::vector<int> pieces_of(const std::vector<Cut>& cuts, double gap) {
  std::vector<int> root(cuts.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int k) {
    while (root[k] != k) k = root[k] = root[root[k]];
    return k;
  };
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    for (std::size_t j = i + 1; j < cuts.size(); ++j) {
      const int a = find(int(i)), b = find(int(j));
      if (a != b && segment_gap(cuts[i], cuts[j]) <= gap) root[std::max(a, b)] = std::min(a, b);
    }
  }
  std::vector<int> out;
  for (std::size_t i = 0; i < cuts.size(); ++i) out.push_back(find(int(i)));
  return out;
}

}  // namespace

struct MeshSections::Impl {
  std::vector<Triangle> triangles;
  Tree tree;
};

MeshSections::MeshSections(const TriMesh& mesh) : impl_(std::make_unique<Impl>()) {
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Triangle t(point_of(mesh.V.row(mesh.F(f, 0))), point_of(mesh.V.row(mesh.F(f, 1))),
                     point_of(mesh.V.row(mesh.F(f, 2))));
    if (!t.is_degenerate()) impl_->triangles.push_back(t);
  }
  if (impl_->triangles.empty()) throw UnfitError("the mesh has no triangle of any area");
  impl_->tree.rebuild(impl_->triangles.begin(), impl_->triangles.end());
  impl_->tree.accelerate_distance_queries();
}
MeshSections::~MeshSections() = default;

Section MeshSections::section(const Vec3& point, const Vec3& normal, double gap) const {
  const Kernel::Plane_3 plane(point_of(point), vector_of(normal));
  std::vector<Iterator> met;
  impl_->tree.all_intersected_primitives(plane, std::back_inserter(met));
  std::vector<Cut> cuts;
  for (const Iterator triangle : met) {
    const auto meeting = CGAL::intersection(plane, *triangle);
    if (!meeting) continue;
    const auto* segment = boost::get<Kernel::Segment_3>(&*meeting);
    if (segment != nullptr)
      cuts.push_back({int(triangle - impl_->triangles.begin()), vec_of(segment->source()),
                      vec_of(segment->target())});
  }
  Section out;
  if (cuts.empty()) return out;
  std::sort(cuts.begin(), cuts.end(),
            [](const Cut& a, const Cut& b) { return a.triangle < b.triangle; });
  const std::vector<int> pieces = pieces_of(cuts, gap);
  int best = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < cuts.size(); ++k) {
    const Vec3 foot = nearest_on_segment(point, cuts[k].a, cuts[k].b);
    if ((foot - point).norm() < nearest)
      nearest = (foot - point).norm(), best = pieces[k], out.nearest = foot;
  }
  for (std::size_t k = 0; k < cuts.size(); ++k) {
    (pieces[k] == best ? out.cuts : out.others).push_back({cuts[k].a, cuts[k].b});
  }
  return out;
}

double MeshSections::distance(const Vec3& point) const {
  return std::sqrt(impl_->tree.squared_distance(point_of(point)));
}

SurfaceDistance surface_distance(const TriMesh& from, const MeshSections& to) {
  double area = 0;
  const auto corner = [&](Eigen::Index f, int k) { return Vec3(from.V.row(from.F(f, k))); };
  const auto area_of = [&](Eigen::Index f) {
    return 0.5 * (corner(f, 1) - corner(f, 0)).cross(corner(f, 2) - corner(f, 0)).norm();
  };
  for (Eigen::Index f = 0; f < from.F.rows(); ++f) area += area_of(f);
  constexpr double kSamples = 8000;
  SurfaceDistance out;
  for (Eigen::Index f = 0; f < from.F.rows(); ++f) {
    const double share = area_of(f) / area;
    const int n = std::clamp(int(std::ceil(std::sqrt(share * kSamples))), 1, 64);
    // Middles of n x n equal triangles.
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < 2 * (n - i) - 1; ++j) {
        const double u = (i + (j % 2 == 0 ? 1.0 : 2.0) / 3) / n,
                     v = (j / 2 + (j % 2 == 0 ? 1.0 : 2.0) / 3) / n;
        const double d = to.distance(corner(f, 0) + u * (corner(f, 1) - corner(f, 0)) +
                                     v * (corner(f, 2) - corner(f, 0)));
        out.mean += d * share / (n * n);
        out.max = std::max(out.max, d);
      }
    }
  }
  return out;
}

}  // namespace ecorche::inline v1
