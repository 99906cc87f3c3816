#include "anatomy/geometry/mesh_rims.h"

#include <set>

namespace ecorche::inline v1 {

std::vector<MeshRim> open_rims(const std::vector<int>& triangles, const Triangles& F) {
  std::set<std::array<int, 2>> edges;
  for (int f : triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = F(f, k), b = F(f, (k + 1) % 3);
      if (edges.erase({b, a}) == 0) edges.insert({a, b});
    }
  std::vector<MeshRim> rims;
  while (!edges.empty()) {
    MeshRim rim;
    auto it = edges.begin();
    while (it != edges.end()) {
      const std::array<int, 2> edge = *it;
      edges.erase(it);
      rim.push_back({edge[1], edge[0]});
      it = edges.lower_bound({edge[1], -1});
      if (it != edges.end() && (*it)[0] != edge[1]) it = edges.end();
    }
    rims.push_back(std::move(rim));
  }
  return rims;
}

}  // namespace ecorche::inline v1
