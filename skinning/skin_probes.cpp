#include "skinning/skin_probes.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>

#include "anatomy/outline.h"
#include "skinning/nearest_surface.h"
#include "skinning/normals.h"

namespace ecorche {
namespace {

constexpr double kNear = 0.025;     // m below the skin at rest: deeper points are not looked at
constexpr float kMargin = 1.2e-3f;  // m
constexpr float kAside = 0.01f, kAsideDepths = 1.5f;  // m; times how deep it lies: further off, another part of the skin may be nearer

// Every second point of the outline from the centre, in single precision.
Wide3 spokes_of(const Ellipse& e, float thickness) {
  static const auto directions = [] {
    std::array<Float8, 2> out{};
    for (int lane = 0; lane < 8; ++lane)
      for (std::size_t k = 0; k < 2; ++k) out[k][lane] = static_cast<float>(outline_directions()[2 * static_cast<std::size_t>(lane)][static_cast<Eigen::Index>(k)]);
    return out;
  }();
  const Float8 factor = __builtin_shufflevector(load8(e.outline.data()), load8(e.outline.data() + 8), 0, 2, 4, 6, 8, 10, 12, 14);
  const Float8 wide = factor * directions[0], thick = factor * directions[1];
  const auto along = [&](int k) {
    return static_cast<float>(e.radii.x() * e.axes(k, 0)) * wide + thickness * static_cast<float>(e.radii.y() * e.axes(k, 1)) * thick;
  };
  return {along(0), along(1), along(2)};
}

Float4 from_point(const Vec3& p, Float4 point) {
  Float4 out{};
  for (int k = 0; k < 3; ++k) out[k] = static_cast<float>(p[k] - static_cast<double>(point[k]));
  return out;
}

Wide3 same(Float4 v) { return {all_eight(v[0]), all_eight(v[1]), all_eight(v[2])}; }

Float4 lane_of(const Wide3& v, std::size_t lane) {
  const int k = static_cast<int>(lane);
  return Float4{v.x[k], v.y[k], v.z[k], 0};
}

Vec3 to_vec3(Float4 v) { return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])}; }

std::vector<float> rows_of(const Points& points) {
  std::vector<float> out;
  for (Eigen::Index v = 0; v < points.rows(); ++v)
    for (int k = 0; k < 4; ++k) out.push_back(k < 3 ? static_cast<float>(points(v, k)) : 1);
  return out;
}

}  // namespace

std::vector<SectionProbes> place_probes(std::span<const Ellipse> rest, std::span<const float> thickness, const TriMesh& skin, const SkinRings& rings) {
  const std::vector<float> positions = rows_of(skin.V);
  std::vector<float> normals(positions.size());
  vertex_normals(positions, std::span(skin.F.data(), static_cast<std::size_t>(skin.F.size())), normals);
  const PosedSkin still{positions, normals};
  const NearestSurface nearest(skin);
  std::vector<SectionProbes> out(rest.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rest.size(), 32), [&](const auto& range) {
    for (std::size_t k = range.begin(); k < range.end(); ++k) {
      SectionProbes& probes = out[k];
      probes.section = static_cast<int>(k);
      const Wide3 spokes = spokes_of(rest[k], thickness[k]);
      for (std::size_t lane = 0; lane < 8; ++lane) {
        const Float4 spoke = lane_of(spokes, lane);
        const Vec3 p = rest[k].center + to_vec3(spoke);
        const SurfacePoint hit = nearest.nearest(p);
        if (hit.distance > kNear) continue;
        const auto far = [&](int corner) { return (skin.V.row(skin.F(hit.triangle, corner)).transpose() - p).squaredNorm(); };
        int corner = 0;
        for (int c = 1; c < 3; ++c)
          if (far(c) < far(corner)) corner = c;
        const int vertex = skin.F(hit.triangle, corner);
        const Lie lie = lie_of(rings, still, from_point(rest[k].center, load4(&positions[4 * static_cast<std::size_t>(vertex)])) + spoke, vertex);
        probes.lanes |= 1u << lane;
        probes.vertex[lane] = vertex;
        probes.margin[lane] = std::min(kMargin, -lie.height - 1e-5f);
      }
    }
  });
  std::erase_if(out, [](const SectionProbes& probes) { return probes.lanes == 0; });
  for (SectionProbes& probes : out)
    for (std::size_t lane = 0; lane < 8; ++lane)
      if ((probes.lanes >> lane & 1) == 0) probes.vertex[lane] = probes.vertex[static_cast<std::size_t>(std::countr_zero(probes.lanes))];
  return out;
}

PosedProbes::PosedProbes(const SectionProbes& probes, const Ellipse& section, float thickness, const PosedSkin& skin)
    : probes_(probes), skin_(skin), spokes_(spokes_of(section, thickness)) {
  const Float4 origin = load4(&skin.positions[4 * static_cast<std::size_t>(probes.vertex[0])]);
  points_ = same(from_point(section.center, origin)) + spokes_ - (xyz(gather_eight(skin.positions.data(), probes.vertex.data())) - same(origin));
}

unsigned PosedProbes::shallow() const {
  const Float8 height = dot(points_, xyz(gather_eight(skin_.normals.data(), probes_.vertex.data())));
  const Float8 aside = most(all_eight(kAside), -kAsideDepths * height);
  const Int8 deep = (height < -kDeepLie) & (dot(points_, points_) - height * height < aside * aside);
  return ~lanes_that(deep) & probes_.lanes;
}

Lie PosedProbes::lie(const SkinRings& rings, std::size_t lane) const { return lie_of(rings, skin_, lane_of(points_, lane), probes_.vertex[lane]); }

Vec3 PosedProbes::spoke(std::size_t lane) const { return to_vec3(lane_of(spokes_, lane)); }

}  // namespace ecorche
