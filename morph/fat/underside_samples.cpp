#include "morph/fat/underside_samples.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "anatomy/geometry/mesh_measures.h"

namespace ecorche::inline v1 {

std::vector<UndersideSample> underside_samples(const TriMesh& skin, const std::vector<float>& layer,
                                               const std::vector<char>& looked_at, double spacing) {
  const Points normals = vertex_normals(skin);
  std::vector<UndersideSample> out;
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f) {
    const auto corner = [&](int i) { return Eigen::Index(skin.F(f, i)); };
    const auto thickness = [&](int i) { return double(layer[std::size_t(corner(i))]); };
    if (!looked_at[std::size_t(corner(0))] || !looked_at[std::size_t(corner(1))] ||
        !looked_at[std::size_t(corner(2))])
      continue;
    const auto place = [&](int i) -> Vec3 {
      return (skin.V.row(corner(i)) - thickness(i) * normals.row(corner(i))).transpose();
    };
    const Vec3 a = place(0), b = place(1), c = place(2);
    const double area = 0.5 * (b - a).cross(c - a).norm();
    const double longest =
        std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
    const int n = std::max(1, int(std::ceil(longest / spacing)));
    const auto add = [&](double u, double v) {
      const double w = 1 - u - v;
      const Vec3 normal =
          (w * normals.row(corner(0)) + u * normals.row(corner(1)) + v * normals.row(corner(2)))
              .transpose();
      if (normal.squaredNorm() > 0.25)
        out.push_back({w * a + u * b + v * c, -normal.normalized(), area / (double(n) * n),
                       w * thickness(0) + u * thickness(1) + v * thickness(2), int(f)});
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

}  // namespace ecorche::inline v1
