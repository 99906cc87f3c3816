#include "skinning/checks/slits.h"

#include <oneapi/tbb/parallel_for.h>

#include <cstddef>

#include "anatomy/queries/nearest_surface.h"
#include "anatomy/queries/ray_caster.h"
#include "morph/fat/underside_samples.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kSlitSpacing =
    0.003;  // m, between points; smaller: more rays, figures much the same
constexpr double kSlitDepth = 0.010;  // m straight in, from where on it is open
constexpr double kSlitSide = 0.008;   // m

}  // namespace

std::vector<double> slit_areas(const TriMesh& skin, const std::vector<float>& layer,
                               const std::vector<char>& looked_at, const TriMesh& flesh) {
  const std::vector<UndersideSample> samples =
      underside_samples(skin, layer, looked_at, kSlitSpacing);
  const SkinRays rays(flesh, RayBuild::quick);
  const NearestSurface nearest(flesh);
  std::vector<int> beside(samples.size(), -1);
  tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t k) {
    const RayHit hit = rays.first_hit(samples[k].point, samples[k].inwards);
    // What is left before anything is entered holds the point.
    if (hit.triangle >= 0 && (hit.facing > 0 || double(hit.distance) <= kSlitDepth)) return;
    const SurfacePoint found = nearest.nearest(samples[k].point);
    if (found.distance <= kSlitSide) beside[k] = found.triangle;
  });
  std::vector<double> out(std::size_t(flesh.F.rows()), 0);
  for (std::size_t k = 0; k < samples.size(); ++k)
    if (beside[k] >= 0) out[std::size_t(beside[k])] += samples[k].area;
  return out;
}

}  // namespace ecorche::inline v1
