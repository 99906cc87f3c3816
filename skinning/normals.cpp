#include "skinning/normals.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "skinning/float4.h"

namespace ecorche {

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
    const Float4 corner = load4(p + a);
    const Float4 area = cross(load4(p + b) - corner, load4(p + c) - corner);
    store4(n + a, load4(n + a) + area);
    store4(n + b, load4(n + b) + area);
    store4(n + c, load4(n + c) + area);
  }
  for (std::size_t i = 0; i < normals.size(); i += 4) {
    const Float4 v = load4(n + i);
    store4(n + i, v * (1.0f / std::sqrt(sum4(v * v)[0] + 1e-30f)));
  }
}

}  // namespace ecorche
