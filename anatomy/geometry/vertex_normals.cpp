#include "anatomy/geometry/vertex_normals.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "anatomy/compute/simd.h"

namespace ecorche::inline v1 {
namespace {

constexpr std::size_t kBlock = 4096;  // vertices a task

void check_sizes(std::span<const float> positions, std::span<const int> triangles,
                 std::span<const float> normals) {
  if (positions.size() != normals.size() || positions.size() % 4 != 0 || triangles.size() % 3 != 0)
    throw std::invalid_argument(
        "vertex_normals: buffers of four floats a vertex and three indices a triangle are needed");
}

// Twice the areas of the triangles about each vertex, as vectors.
void sum_areas(std::span<const float> positions, std::span<const int> triangles,
               std::span<float> sums) {
  std::fill(sums.begin(), sums.end(), 0.0f);
  const float* p = positions.data();
  float* n = sums.data();
  for (std::size_t f = 0; f < triangles.size(); f += 3) {
    const std::size_t a = 4 * std::size_t(triangles[f]);
    const std::size_t b = 4 * std::size_t(triangles[f + 1]);
    const std::size_t c = 4 * std::size_t(triangles[f + 2]);
    const Float4 corner = load4(p + a);
    const Float4 area = cross(load4(p + b) - corner, load4(p + c) - corner);
    store4(n + a, load4(n + a) + area);
    store4(n + b, load4(n + b) + area);
    store4(n + c, load4(n + c) + area);
  }
}

Float4 unit(Float4 v) { return v * (1.0f / std::sqrt(sum4(v * v)[0] + 1e-30f)); }

}  // namespace

void vertex_normals(std::span<const float> positions, std::span<const int> triangles,
                    std::span<float> normals) {
  check_sizes(positions, triangles, normals);
  sum_areas(positions, triangles, normals);
  for (std::size_t i = 0; i < normals.size(); i += 4) store4(&normals[i], unit(load4(&normals[i])));
}

void vertex_normals(std::span<const float> positions, std::span<const int> triangles,
                    std::span<float> normals, std::vector<float>& half) {
  check_sizes(positions, triangles, normals);
  half.resize(normals.size());
  const std::size_t middle = triangles.size() / 6 * 3;
  tbb::parallel_invoke([&] { sum_areas(positions, triangles.first(middle), normals); },
                       [&] { sum_areas(positions, triangles.subspan(middle), half); });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, normals.size() / 4, kBlock),
                    [&](const auto& range) {
                      for (std::size_t i = 4 * range.begin(); i < 4 * range.end(); i += 4)
                        store4(&normals[i], unit(load4(&normals[i]) + load4(&half[i])));
                    });
}

}  // namespace ecorche::inline v1
