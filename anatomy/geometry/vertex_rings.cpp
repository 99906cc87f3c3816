#include "anatomy/geometry/vertex_rings.h"

#include <algorithm>

namespace ecorche::inline v1 {

std::vector<std::vector<int>> vertex_neighbours(const TriMesh& mesh) {
  std::vector<std::vector<int>> out(mesh.V.rows());
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      out[mesh.F(f, k)].push_back(mesh.F(f, (k + 1) % 3));
      out[mesh.F(f, k)].push_back(mesh.F(f, (k + 2) % 3));
    }
  for (std::vector<int>& row : out) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
  }
  return out;
}

}  // namespace ecorche::inline v1
