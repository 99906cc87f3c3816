#include <algorithm>
#include <cstdint>
#include <numeric>
#include <unordered_map>

#include "anatomy/geometry/subdivide.h"

namespace ecorche {
namespace {

// Spreads the lower 21 bits to every third bit.
std::uint64_t spread(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x001f00000000ffff;
  x = (x | x << 16) & 0x001f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  x = (x | x << 2) & 0x1249249249249249;
  return x;
}

std::vector<int> inverse(const std::vector<int>& order) {
  std::vector<int> out(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) out[order[k]] = int(k);
  return out;
}

// Triangles by their lowest vertex: the vertices' own order is spatial already.
std::vector<int> face_order(const Triangles& F) {
  std::vector<int> order(F.rows());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return F.row(a).minCoeff() < F.row(b).minCoeff(); });
  return order;
}

Triangles renumbered(const Triangles& F, const std::vector<int>& new_of_old) {
  return F.unaryExpr([&](int i) { return new_of_old[i]; });
}

template <typename Rows>
Rows picked(const Rows& rows, const std::vector<int>& order) {
  Rows out(rows.rows(), rows.cols());
  for (std::size_t k = 0; k < order.size(); ++k) out.row(k) = rows.row(order[k]);
  return out;
}

// Where the loops of a mesh with a boundary run: next[a] = b along its edges without a partner.
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

std::vector<int> spatial_order(const Points& V) {
  std::vector<int> order(V.rows());
  std::iota(order.begin(), order.end(), 0);
  if (V.rows() == 0) return order;
  const Eigen::RowVector3d low = V.colwise().minCoeff();
  const double size = std::max((V.colwise().maxCoeff() - low).maxCoeff(), 1e-30);
  std::vector<std::uint64_t> keys;
  keys.reserve(order.size());
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k)
      key |= spread(std::uint64_t((V(i, k) - low[k]) / size * 2097151)) << k;
    keys.push_back(key);
  }
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return keys[a] < keys[b]; });
  return order;
}

TriMesh reordered(const TriMesh& mesh, const std::vector<int>& order) {
  TriMesh out{picked(mesh.V, order), renumbered(mesh.F, inverse(order))};
  out.F = picked(out.F, face_order(out.F));
  return out;
}

Refinement reordered(const Refinement& refinement, const std::vector<int>& order) {
  const std::vector<int> new_of_old = inverse(order);
  Refinement out;
  Eigen::PermutationMatrix<Eigen::Dynamic> rows(order.size());
  for (std::size_t k = 0; k < new_of_old.size(); ++k) rows.indices()[k] = new_of_old[k];
  out.map = rows * refinement.map;
  out.F = renumbered(refinement.F, new_of_old);
  const std::vector<int> faces = face_order(out.F);
  out.F = picked(out.F, faces);
  for (int f : faces) out.parents.push_back(refinement.parents[f]);
  for (int i : refinement.base_rows) out.base_rows.push_back(new_of_old[i]);
  return out;
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

}  // namespace ecorche
