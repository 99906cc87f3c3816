#include "anatomy/geometry/vertex_order.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace ecorche::inline v1 {
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

}  // namespace ecorche::inline v1
