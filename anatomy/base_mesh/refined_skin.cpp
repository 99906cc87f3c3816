#include "anatomy/base_mesh/refined_skin.h"

#include <algorithm>
#include <unordered_map>

#include "anatomy/geometry/vertex_order.h"

namespace ecorche::inline v1 {
namespace {

// Boundary loops of a mesh: next[a] = b along its edges without a partner.
std::unordered_map<int, int> open_edges(const Triangles& F) {
  std::vector<std::pair<int, int>> edges;
  edges.reserve(F.size());
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) edges.emplace_back(F(f, k), F(f, (k + 1) % 3));
  }
  std::sort(edges.begin(), edges.end());
  std::unordered_map<int, int> next;
  for (const auto& [a, b] : edges) {
    if (!std::binary_search(edges.begin(), edges.end(), std::pair(b, a))) next[b] = a;
  }
  return next;
}

}  // namespace

Refinement refine_skin(const BodyPackage& package) {
  const Refinement fine = refine(package.triangles, package.skin_size, 1);
  return reordered(fine,
                   spatial_order(refine_points(fine, package.points.topRows(package.skin_size))));
}

TriMesh capped_skin(const BodyPackage& package, const Refinement& refinement, const Points& fine) {
  std::vector<bool> removed(package.quads.rows(), false);
  for (const auto& cavity : package.cavities) {
    for (int q : cavity.quads) removed[q] = true;
  }
  std::vector<int> kept;
  for (Eigen::Index f = 0; f < refinement.F.rows(); ++f) {
    if (removed[refinement.parents[f] / 2]) continue;
    for (int k = 0; k < 3; ++k) kept.push_back(refinement.F(f, k));
  }
  const auto next =
      open_edges(Eigen::Map<const Triangles>(kept.data(), Eigen::Index(kept.size() / 3), 3));
  TriMesh out;
  const auto vertices = refinement.map.rows();
  out.V.resize(vertices + Eigen::Index(package.cavities.size()), 3);
  out.V.topRows(vertices) = fine;
  for (std::size_t c = 0; c < package.cavities.size(); ++c) {
    const int start = refinement.base_rows[package.cavities[c].loop[0]];
    const auto centre = vertices + Eigen::Index(c);
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    double count = 0;
    for (int a = start, b = next.at(a);; a = b, b = next.at(a)) {
      kept.insert(kept.end(), {a, b, int(centre)});
      sum += fine.row(a);
      ++count;
      if (b == start) break;
    }
    out.V.row(centre) = sum / count;
  }
  out.F = Eigen::Map<const Triangles>(kept.data(), Eigen::Index(kept.size() / 3), 3);
  return out;
}

}  // namespace ecorche::inline v1
