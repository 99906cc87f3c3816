#include "skinning/muscle_collision/outline_probes.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <optional>

#include "anatomy/muscles/slice_outline.h"
#include "anatomy/queries/nearest_surface.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kNear = 0.025;     // m below the skin at rest; deeper points get no probe
constexpr float kMargin = 1.2e-3f;  // m, that probes stay below the skin

Float4 from_point(const Vec3& p, Float4 point) {
  Float4 out{};
  for (int k = 0; k < 3; ++k) out[k] = float(p[k] - double(point[k]));
  return out;
}

Wide3 same(Float4 v) { return {all_eight(v[0]), all_eight(v[1]), all_eight(v[2])}; }

// Relative to the vertices.
Wide3 points_of(const SectionProbes& probes, const Ellipse& section, const Wide3& radials,
                const PosedSkin& skin) {
  const Float4 origin = load4(&skin.positions[4 * probes.vertex[0]]);
  return same(from_point(section.center, origin)) + radials -
         (xyz(gather_eight(skin.positions.data(), probes.vertex.data())) - same(origin));
}

// Lanes without a probe have the vertex of the first one with a probe.
void fill_up(SectionProbes& probes) {
  for (std::size_t lane = 0; lane < 8; ++lane)
    if ((probes.lanes >> lane & 1) == 0)
      probes.vertex[lane] = probes.vertex[std::countr_zero(probes.lanes)];
}

}  // namespace

Wide3 probe_radials(const Ellipse& e, float thickness) {
  static const auto directions = [] {
    std::array<Float8, 2> out{};
    for (int lane = 0; lane < 8; ++lane)
      for (std::size_t k = 0; k < 2; ++k) out[k][lane] = float(outline_directions()[2 * lane][k]);
    return out;
  }();
  const Float8 factor = __builtin_shufflevector(
      load8(e.outline.data()), load8(e.outline.data() + 8), 0, 2, 4, 6, 8, 10, 12, 14);
  const Float8 wide = factor * directions[0], thick = factor * directions[1];
  const auto along = [&](int k) {
    return float(e.radii.x() * e.axes(k, 0)) * wide +
           thickness * float(e.radii.y() * e.axes(k, 1)) * thick;
  };
  return {along(0), along(1), along(2)};
}

std::vector<SectionProbes> place_probes(std::span<const Ellipse> rest,
                                        std::span<const float> thickness, const TriMesh& skin,
                                        const SkinRings& rings) {
  const StillSkin rows = make_still_skin(skin);
  const PosedSkin still{rows.positions, rows.normals};
  const NearestSurface nearest(skin);
  std::vector<SectionProbes> out(rest.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rest.size(), 32), [&](const auto& range) {
    for (std::size_t k = range.begin(); k < range.end(); ++k) {
      SectionProbes& probes = out[k];
      probes.section = int(k);
      const Wide3 radials = probe_radials(rest[k], thickness[k]);
      for (std::size_t lane = 0; lane < 8; ++lane) {
        const int at = lane;
        const Vec3 p = rest[k].center + Vec3(radials.x[at], radials.y[at], radials.z[at]);
        const std::optional<SurfacePoint> hit = nearest.nearest_within(p, kNear);
        if (!hit) continue;
        probes.lanes |= 1u << lane;
        probes.vertex[lane] = nearest_vertex(skin, *hit, p);
      }
      if (probes.lanes == 0) continue;
      fill_up(probes);
      const SkinProjections projections =
          project_to_skin(rings, still, points_of(probes, rest[k], radials, still), probes.vertex);
      for (int lane = 0; lane < 8; ++lane)
        probes.margin[lane] = std::min(kMargin, -projections.height[lane] - 1e-5f);
    }
  });
  std::erase_if(out, [](const SectionProbes& probes) { return probes.lanes == 0; });
  return out;
}

void ShallowProbes::add(int owner, const SectionProbes& probes, const Ellipse& section,
                        float thickness, const PosedSkin& skin) {
  const Wide3 points = points_of(probes, section, probe_radials(section, thickness), skin);
  const Float8 height = dot(points, xyz(gather_eight(skin.normals.data(), probes.vertex.data())));
  const Float8 aside = most(all_eight(kAside), -kAsideDepths * height);
  const Int8 deep =
      (height < -kDeepProjection) & (dot(points, points) - height * height < aside * aside);
  for (unsigned lanes = ~lanes_that(deep) & probes.lanes; lanes != 0; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    x_[count_] = points.x[lane];
    y_[count_] = points.y[lane];
    z_[count_] = points.z[lane];
    ProbeProjection& projection = projections_[count_++];
    projection.owner = owner;
    projection.lane = lane;
    projection.vertex = probes.vertex[projection.lane];
  }
}

std::span<const ProbeProjection> ShallowProbes::project(const SkinRings& rings,
                                                        const PosedSkin& skin) {
  for (std::size_t begin = 0; begin < count_; begin += 8) {
    const std::size_t end = std::min(begin + 8, count_);
    std::array<int, 8> from;
    for (std::size_t lane = 0; lane < 8; ++lane) {
      const std::size_t k = std::min(begin + lane, end - 1);  // the last one fills up
      from[lane] = projections_[k].vertex;
      x_[begin + lane] = x_[k];
      y_[begin + lane] = y_[k];
      z_[begin + lane] = z_[k];
    }
    const SkinProjections projections = project_to_skin(
        rings, skin, {load8(&x_[begin]), load8(&y_[begin]), load8(&z_[begin])}, from);
    for (std::size_t k = begin; k < end; ++k) {
      const int lane = k - begin;
      projections_[k].vertex = projections.vertex[k - begin];
      projections_[k].height = projections.height[lane];
      projections_[k].normal = Float4{projections.normal.x[lane], projections.normal.y[lane],
                                      projections.normal.z[lane], 0};
    }
  }
  return {projections_.data(), count_};
}

}  // namespace ecorche::inline v1
