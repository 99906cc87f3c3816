#include "skinning/settle/swelling_limits.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

#include "anatomy/compute/simd.h"
#include "anatomy/geometry/vertex_normals.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kMostTissue = 0.05;  // m; deeper tissue swells no more
constexpr double kMostBend = 1;       // change of an edge by a unit, as a fraction of its length
constexpr double kSlope = 0.5;        // m a m of skin, of the limits

struct Neighbour {
  int vertex = 0;
  double distance = 0;  // m
};

// Lowers the lengths so that none is above another one by more than the slope over the way between
// them (Dijkstra's order).
void limit_slope(const std::vector<std::vector<Neighbour>>& rings, std::vector<double>& lengths) {
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> shortest;
  for (std::size_t i = 0; i < lengths.size(); ++i) shortest.emplace(lengths[i], int(i));
  while (!shortest.empty()) {
    const auto [length, i] = shortest.top();
    shortest.pop();
    if (length > lengths[i]) continue;
    for (const Neighbour& each : rings[i]) {
      double& other = lengths[each.vertex];
      const double most = length + kSlope * each.distance;
      if (most >= other) continue;
      other = most;
      shortest.emplace(most, each.vertex);
    }
  }
}

}  // namespace

std::vector<double> find_swelling_limits(std::span<const float> positions,
                                         std::span<const int> triangles,
                                         std::span<const double> tissue) {
  std::vector<float> normals(positions.size());
  vertex_normals(positions, triangles, normals);
  std::vector<double> out;
  for (const double t : tissue) out.push_back(std::min(t, kMostTissue));
  std::vector<std::vector<Neighbour>> rings(out.size());
  for (std::size_t f = 0; f < triangles.size(); f += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = triangles[f + k], b = triangles[f + (k + 1) % 3];
      const std::size_t i = std::size_t(a), j = b;
      const Float4 edge = load4(&positions[4 * j]) - load4(&positions[4 * i]),
                   turn = load4(&normals[4 * j]) - load4(&normals[4 * i]);
      const double square = double(sum4(edge * edge)[0]),
                   bend = std::abs(double(sum4(edge * turn)[0]));
      for (const std::size_t v : {i, j})
        if (bend * out[v] > kMostBend * square) out[v] = kMostBend * square / bend;
      rings[i].push_back({b, std::sqrt(square)});
      rings[j].push_back({a, std::sqrt(square)});
    }
  limit_slope(rings, out);
  return out;
}

}  // namespace ecorche::inline v1
