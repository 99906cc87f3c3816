#include "skinning/interior/skin_controls.h"

#include <algorithm>
#include <limits>

#include "anatomy/geometry/edge_walker.h"

namespace ecorche::inline v1 {

SkinControls choose_skin_controls(const TriMesh& skin, double spacing) {
  EdgeWalker walker(skin);
  const std::size_t count = skin.V.rows();
  const double reach = 2 * spacing;
  std::vector<std::vector<std::pair<int, double>>> near(count);
  std::vector<double> nearest(count, std::numeric_limits<double>::infinity());
  SkinControls out;
  for (std::size_t v = 0; v < count; ++v) {
    if (nearest[v] < spacing || walker.neighbours(int(v)).empty()) continue;
    const int control = int(out.vertices.size());
    out.vertices.push_back(int(v));
    walker.walk(int(v), reach, [&](int i, double d) {
      nearest[i] = std::min(nearest[i], d);
      near[i].emplace_back(control, (1 - d / reach) * (1 - d / reach));
    });
  }
  for (const auto& weights : near) out.weights.push_back(largest_weights(weights));
  return out;
}

}  // namespace ecorche::inline v1
