#include "skinning/interior/skin_controls.h"

#include <functional>
#include <limits>
#include <queue>

#include "anatomy/geometry/vertex_rings.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kUnreached = std::numeric_limits<double>::infinity();

}  // namespace

SkinControls choose_skin_controls(const TriMesh& skin, double spacing) {
  const std::vector<std::vector<int>> neighbours = vertex_neighbours(skin);
  const std::size_t count = neighbours.size();
  const double reach = 2 * spacing;
  std::vector<std::vector<std::pair<int, double>>> near(count);
  std::vector<double> nearest(count, kUnreached), distance(count, kUnreached);
  SkinControls out;
  for (std::size_t v = 0; v < count; ++v) {
    if (nearest[v] < spacing || neighbours[v].empty()) continue;
    const int control = int(out.vertices.size());
    out.vertices.push_back(int(v));
    using Reached = std::pair<double, int>;
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> front;
    front.emplace(0.0, int(v));
    distance[v] = 0;
    std::vector<int> touched{int(v)};
    while (!front.empty()) {
      const auto [d, i] = front.top();
      front.pop();
      if (d > distance[i]) continue;
      nearest[i] = std::min(nearest[i], d);
      near[i].emplace_back(control, (1 - d / reach) * (1 - d / reach));
      for (const int k : neighbours[i]) {
        const double next = d + (skin.V.row(i) - skin.V.row(k)).norm();
        if (next >= reach || next >= distance[k]) continue;
        if (distance[k] == kUnreached) touched.push_back(k);
        distance[k] = next;
        front.emplace(next, k);
      }
    }
    for (const int i : touched) distance[i] = kUnreached;
  }
  for (const auto& weights : near) out.weights.push_back(largest_weights(weights));
  return out;
}

}  // namespace ecorche::inline v1
