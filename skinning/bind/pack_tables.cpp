#include "skinning/bind/pack_tables.h"

#include "anatomy/geometry/subdivide.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "anatomy/geometry/subdivide.h"

namespace ecorche {
namespace {

// vertices that are regrouped by shape: small enough to stay in the nearest cache
constexpr int kBlock = 1024;

// Whether neighbours on the surface are mostly neighbours in memory already.
bool is_local(const TriMesh& skin) {
  Eigen::Index near = 0;
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f)
    near += skin.F.row(f).maxCoeff() - skin.F.row(f).minCoeff() < 2 * kBlock;
  return near > 0.9 * double(skin.F.rows());
}

std::vector<int> memory_order(const TriMesh& skin) {
  if (!is_local(skin)) return spatial_order(skin.V);
  std::vector<int> order(skin.V.rows());
  std::iota(order.begin(), order.end(), 0);
  return order;
}

}  // namespace

void lay_out(const TriMesh& skin, const std::vector<ShareRow>& rows,
             const std::vector<ShareRow>& node_rows, SkinTables& tables) {
  const int n = skin.V.rows();
  tables.vertex_count = n;
  tables.order = memory_order(skin);
  std::vector<int> sorted_place(n);
  for (int s = 0; s < n; ++s) sorted_place[tables.order[s]] = s;

  // Triangles in sorted vertices, ordered by their lowest one.
  std::vector<std::array<int, 3>> triangles(skin.F.rows());
  for (std::size_t f = 0; f < triangles.size(); ++f)
    for (int k = 0; k < 3; ++k) triangles[f][k] = sorted_place[skin.F(f, k)];
  std::stable_sort(triangles.begin(), triangles.end(), [](const auto& a, const auto& b) {
    return *std::min_element(a.begin(), a.end()) < *std::min_element(b.begin(), b.end());
  });
  for (const std::array<int, 3>& t : triangles)
    tables.triangles.insert(tables.triangles.end(), t.begin(), t.end());

  // Within each block, vertices of equal shape follow each other.
  const auto shape = [&](int s) {
    const std::size_t v = tables.order[s];
    return std::pair<int, int>(int(rows[v].size()),
                               int(node_rows.empty() ? 0 : node_rows[v].size()));
  };
  tables.place.resize(n);
  std::iota(tables.place.begin(), tables.place.end(), 0);
  for (int begin = 0; begin < n; begin += kBlock)
    std::stable_sort(tables.place.begin() + begin,
                     tables.place.begin() + std::min(n, begin + kBlock),
                     [&](int a, int b) { return shape(a) < shape(b); });

  const Vec3 root = tables.origins[0];
  for (int e = 0; e < n; ++e) {
    const int s = tables.place[e];
    const std::size_t v = tables.order[s];
    const auto [carriers, nodes] = shape(s);
    if (tables.runs.empty() || tables.runs.back().carriers != carriers ||
        tables.runs.back().nodes != nodes)
      tables.runs.push_back({e, e, carriers, nodes, tables.carrier.size(), tables.node.size()});
    tables.runs.back().end = e + 1;
    for (int k = 0; k < 3; ++k) tables.rest.push_back(float(skin.V(v, k) - root[k]));
    tables.rest.push_back(1);
    for (const Influence& w : rows[v]) {
      tables.carrier.push_back(std::uint16_t(w.joint));
      tables.carrier_weight.push_back(float(w.weight));
    }
    for (int k = 0; k < nodes; ++k) {
      tables.node.push_back(std::uint16_t(node_rows[v][k].joint));
      tables.node_weight.push_back(float(node_rows[v][k].weight));
    }
  }
  if (std::is_sorted(tables.order.begin(), tables.order.end())) tables.order.clear();
}

}  // namespace ecorche
