#include "skinning/normals.h"

#include <algorithm>
#include <stdexcept>

namespace ecorche {
namespace {

using Row = Eigen::Array4f;

}  // namespace

void vertex_normals(std::span<const float> positions, std::span<const int> triangles, std::span<float> normals) {
  if (positions.size() != normals.size() || positions.size() % 4 != 0 || triangles.size() % 3 != 0)
    throw std::invalid_argument("vertex_normals: buffers of four floats a vertex and three indices a triangle are needed");
  std::fill(normals.begin(), normals.end(), 0.0f);
  const float* p = positions.data();
  float* n = normals.data();
  for (std::size_t f = 0; f < triangles.size(); f += 3) {
    const std::size_t a = 4 * static_cast<std::size_t>(triangles[f]);
    const std::size_t b = 4 * static_cast<std::size_t>(triangles[f + 1]);
    const std::size_t c = 4 * static_cast<std::size_t>(triangles[f + 2]);
    const Row pa = Eigen::Map<const Row>(p + a);
    const Row u = Eigen::Map<const Row>(p + b) - pa, v = Eigen::Map<const Row>(p + c) - pa;
    const Row area(u.y() * v.z() - u.z() * v.y(), u.z() * v.x() - u.x() * v.z(), u.x() * v.y() - u.y() * v.x(), 0.0f);
    Eigen::Map<Row>(n + a) += area;
    Eigen::Map<Row>(n + b) += area;
    Eigen::Map<Row>(n + c) += area;
  }
  for (std::size_t i = 0; i < normals.size(); i += 4) {
    const float length2 = n[i] * n[i] + n[i + 1] * n[i + 1] + n[i + 2] * n[i + 2];
    const float scale = length2 > 0 ? 1.0f / std::sqrt(length2) : 0.0f;
    for (int k = 0; k < 3; ++k) n[i + static_cast<std::size_t>(k)] *= scale;
  }
}

}  // namespace ecorche
