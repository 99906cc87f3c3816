#include "morph/dilation/spoke_limits.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace ecorche::inline v1 {
namespace {

// of the layer, that points of an outline may stand into it: facets are chords and lie lower
constexpr float kTip = 0.25f;
constexpr double kSteepest = 0.25;  // least cosine that the layer's slope is taken to have

// Directions that move a vertex, of what is not its partner's mirror image.
std::vector<char> used_directions(const PackedSections& all, std::span<const char> asked) {
  std::vector<char> used(all.slices.size() * kOutlinePoints, 0);
  for (const StripPlace& strip : all.strips)
    for (std::size_t k = strip.begin;
         k < strip.end && !all.is_mirrored(strip) && asked[std::size_t(strip.muscle)]; ++k)
      for (std::size_t i = 0; i < kOutlinePoints; ++i)
        used[k * kOutlinePoints + i] = char(all.is_drawn(k, i));
  return used;
}

}  // namespace

RadialLimits find_radial_limits(const PackedSections& all, std::span<const char> asked,
                                const SkinRays& skin, const FatLayer& fat,
                                const Underside& underside, double skin_gap) {
  const SkinRays layer_rays(TriMesh{underside.points, skin.mesh().F});
  RadialLimits out;
  out.spokes.resize(all.slices.size() * kOutlinePoints);
  const std::vector<char> used = used_directions(all, asked);
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, all.slices.size(), 16), [&](const auto& range) {
        for (std::size_t k = range.begin(); k < range.end(); ++k)
          for (std::size_t i = 0; i < kOutlinePoints; ++i) {
            if (!used[k * kOutlinePoints + i]) continue;
            const Vec3 to_edge = all.edge(k, i);
            RadialLimit& spoke = out.spokes[k * kOutlinePoints + i];
            spoke.base = std::max(float(to_edge.norm()), 1e-6f);
            const Vec3 direction = to_edge / double(spoke.base);
            const RayHit hit = skin.first_hit(all.slices[k].center, direction);
            if (hit.triangle < 0) continue;
            const float thickness = rounded(double(fat.at(skin.mesh().F, hit)));
            const float layer = thickness / std::max(hit.facing, float(kSteepest));
            spoke.layer = hit.distance - layer;
            // Where the skin is round, a ray that leans leaves the underside later than its tangent
            // plane.
            const RayHit under =
                layer_rays.first_hit(all.slices[k].center, direction, double(hit.distance));
            if (under.triangle >= 0 && under.facing > 0)
              spoke.layer = std::max(spoke.layer, under.distance);
            spoke.over = spoke.layer + kTip * thickness;
            // Only ellipses that press into the layer may go on doing so, by half of it.
            spoke.most =
                std::max(spoke.over,
                         std::min(spoke.base, hit.distance - std::max(layer / 2, float(skin_gap))));
          }
      });
  out.rays = 2 * std::count(used.begin(), used.end(), 1);
  return out;
}

}  // namespace ecorche::inline v1
