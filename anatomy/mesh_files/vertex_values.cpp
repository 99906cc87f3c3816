#include "anatomy/mesh_files/vertex_values.h"

#include <algorithm>

namespace ecorche::inline v1 {

Points unit_normals(const std::vector<double>& xyz) {
  Points out = Eigen::Map<const Points>(xyz.data(), Eigen::Index(xyz.size() / 3), 3);
  for (Eigen::Index i = 0; i < out.rows(); ++i) {
    const double length = out.row(i).stableNorm();
    if (length > 0) out.row(i) /= length;
  }
  return out;
}

Colours colours_in_range(const std::vector<float>& rgb) {
  Colours out = Eigen::Map<const Colours>(rgb.data(), Eigen::Index(rgb.size() / 3), 3);
  if (out.size() > 0 && out.maxCoeff() > 1) out /= 255;
  return out.cwiseMax(0).cwiseMin(1);
}

TextureCoordinates corner_texture(const std::vector<float>& uv, const Triangles& F) {
  TextureCoordinates out(F.size(), 2);
  for (Eigen::Index c = 0; c < F.size(); ++c)
    out.row(c) << uv[2 * std::size_t(F.data()[c])], uv[2 * std::size_t(F.data()[c]) + 1];
  return out;
}

}  // namespace ecorche::inline v1
