#include "skinning/bind/pack_mesh.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "anatomy/geometry/vertex_order.h"

namespace ecorche::inline v1 {
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

BlendMesh pack_mesh(const TriMesh& skin, const Vec3& root, const SkinWeights& weights) {
  const std::vector<WeightRow>& rows = weights.frames;
  const std::vector<WeightRow>& handle_rows = weights.handles;
  BlendMesh mesh;
  const int n = skin.V.rows();
  mesh.vertex_count = n;
  mesh.order = memory_order(skin);
  std::vector<int> sorted_place(n);
  for (int s = 0; s < n; ++s) sorted_place[mesh.order[s]] = s;

  // Triangles in sorted vertices, ordered by their lowest one.
  std::vector<std::array<int, 3>> triangles(skin.F.rows());
  for (std::size_t f = 0; f < triangles.size(); ++f)
    for (int k = 0; k < 3; ++k) triangles[f][k] = sorted_place[skin.F(f, k)];
  std::stable_sort(triangles.begin(), triangles.end(), [](const auto& a, const auto& b) {
    return *std::min_element(a.begin(), a.end()) < *std::min_element(b.begin(), b.end());
  });
  for (const std::array<int, 3>& t : triangles)
    mesh.triangles.insert(mesh.triangles.end(), t.begin(), t.end());

  // Within each block, vertices of equal shape follow each other.
  const auto shape = [&](int s) {
    const std::size_t v = mesh.order[s];
    return std::pair<int, int>(int(rows[v].size()),
                               int(handle_rows.empty() ? 0 : handle_rows[v].size()));
  };
  mesh.sorted_index.resize(n);
  std::iota(mesh.sorted_index.begin(), mesh.sorted_index.end(), 0);
  for (int begin = 0; begin < n; begin += kBlock)
    std::stable_sort(mesh.sorted_index.begin() + begin,
                     mesh.sorted_index.begin() + std::min(n, begin + kBlock),
                     [&](int a, int b) { return shape(a) < shape(b); });

  for (int e = 0; e < n; ++e) {
    const int s = mesh.sorted_index[e];
    const std::size_t v = mesh.order[s];
    const auto [frames, handles] = shape(s);
    if (mesh.runs.empty() || mesh.runs.back().frames != frames ||
        mesh.runs.back().handles != handles)
      mesh.runs.push_back({e, e, frames, handles, mesh.frame.size(), mesh.handle.size()});
    mesh.runs.back().end = e + 1;
    for (int k = 0; k < 3; ++k) mesh.rest.push_back(float(skin.V(v, k) - root[k]));
    mesh.rest.push_back(1);
    for (const Influence& w : rows[v]) {
      mesh.frame.push_back(std::uint16_t(w.joint));
      mesh.frame_weight.push_back(float(w.weight));
    }
    for (int k = 0; k < handles; ++k) {
      mesh.handle.push_back(std::uint16_t(handle_rows[v][k].joint));
      mesh.handle_weight.push_back(float(handle_rows[v][k].weight));
    }
  }
  if (std::is_sorted(mesh.order.begin(), mesh.order.end())) mesh.order.clear();
  return mesh;
}

}  // namespace ecorche::inline v1
