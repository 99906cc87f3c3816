#include "anatomy/geometry/mesh_islands.h"

#include <algorithm>
#include <array>
#include <map>

namespace ecorche::inline v1 {

std::vector<int> mesh_islands(const TriMesh& mesh) {
  std::vector<int> root(mesh.V.rows());
  std::map<std::array<double, 3>, int> place;
  for (int i = 0; i < int(root.size()); ++i) {
    root[i] = i;
    const Vec3 p = mesh.V.row(i);
    if (p.allFinite())
      root[i] = place.emplace(std::array<double, 3>{p.x(), p.y(), p.z()}, i).first->second;
  }
  const auto find = [&](int i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    for (int k = 1; k < 3; ++k) {
      const auto [low, high] = std::minmax({find(mesh.F(f, 0)), find(mesh.F(f, k))});
      root[high] = low;
    }
  for (int i = 0; i < int(root.size()); ++i) root[i] = find(i);
  return root;
}

}  // namespace ecorche::inline v1
