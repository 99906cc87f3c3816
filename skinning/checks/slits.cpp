#include "skinning/checks/slits.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/queries/nearest_surface.h"
#include "anatomy/queries/ray_caster.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kSlitSpacing =
    0.003;  // m, between points; smaller: more rays, figures much the same
constexpr double kSlitDepth = 0.010;  // m straight in, from where on it is open
constexpr double kSlitSide = 0.008;   // m

struct Sample {
  Vec3 point = Vec3::Zero(), inwards = Vec3::Zero();
  double area = 0;
};

// Points of the layer's underside, spread evenly over its triangles.
std::vector<Sample> underside_samples(const TriMesh& skin, const std::vector<float>& layer,
                                      const std::vector<char>& looked_at) {
  const Points normals = vertex_normals(skin);
  std::vector<Sample> out;
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f) {
    const auto corner = [&](int i) { return Eigen::Index(skin.F(f, i)); };
    if (!looked_at[std::size_t(corner(0))] || !looked_at[std::size_t(corner(1))] ||
        !looked_at[std::size_t(corner(2))])
      continue;
    const auto place = [&](int i) -> Vec3 {
      return (skin.V.row(corner(i)) -
              double(layer[std::size_t(corner(i))]) * normals.row(corner(i)))
          .transpose();
    };
    const Vec3 a = place(0), b = place(1), c = place(2);
    const double area = 0.5 * (b - a).cross(c - a).norm();
    const double longest =
        std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
    const int n = std::max(1, int(std::ceil(longest / kSlitSpacing)));
    const auto add = [&](double u, double v) {
      const double w = 1 - u - v;
      const Vec3 normal =
          (w * normals.row(corner(0)) + u * normals.row(corner(1)) + v * normals.row(corner(2)))
              .transpose();
      if (normal.squaredNorm() > 0.25)
        out.push_back({w * a + u * b + v * c, -normal.normalized(), area / (double(n) * n)});
    };
    // The middles of n x n equal triangles.
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        add((i + 1.0 / 3) / n, (j + 1.0 / 3) / n);
        if (i + j + 1 < n) add((i + 2.0 / 3) / n, (j + 2.0 / 3) / n);
      }
  }
  return out;
}

}  // namespace

std::vector<double> slit_areas(const TriMesh& skin, const std::vector<float>& layer,
                               const std::vector<char>& looked_at, const TriMesh& flesh) {
  const std::vector<Sample> samples = underside_samples(skin, layer, looked_at);
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
