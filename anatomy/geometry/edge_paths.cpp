#include "anatomy/geometry/edge_paths.h"

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <queue>

namespace ecorche::inline v1 {

TriMesh welded(const TriMesh& mesh) {
  std::map<std::array<double, 3>, int> known;
  std::vector<int> new_of_old;
  std::vector<double> coordinates;
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    const std::array<double, 3> key{mesh.V(i, 0), mesh.V(i, 1), mesh.V(i, 2)};
    const auto [place, fresh] = known.emplace(key, int(known.size()));
    if (fresh) coordinates.insert(coordinates.end(), key.begin(), key.end());
    new_of_old.push_back(place->second);
  }
  TriMesh out;
  out.V = Eigen::Map<const Points>(coordinates.data(), Eigen::Index(coordinates.size() / 3), 3);
  std::vector<int> corners;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const auto at = [&](int k) { return new_of_old[mesh.F(f, k)]; };
    if (at(0) != at(1) && at(1) != at(2) && at(2) != at(0))
      corners.insert(corners.end(), {at(0), at(1), at(2)});
  }
  out.F = Eigen::Map<const Triangles>(corners.data(), Eigen::Index(corners.size() / 3), 3);
  return out;
}

std::vector<double> edge_distances(const TriMesh& mesh, int from) {
  std::vector<std::vector<int>> neighbours(mesh.V.rows());
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      neighbours[mesh.F(f, k)].push_back(mesh.F(f, (k + 1) % 3));
      neighbours[mesh.F(f, (k + 1) % 3)].push_back(mesh.F(f, k));
    }
  }
  std::vector<double> distance(neighbours.size(), std::numeric_limits<double>::infinity());
  std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>>
      open;
  distance[from] = 0;
  open.emplace(0, from);
  while (!open.empty()) {
    const auto [d, i] = open.top();
    open.pop();
    if (d > distance[i]) continue;
    for (int j : neighbours[i]) {
      const double further = d + (mesh.V.row(i) - mesh.V.row(j)).norm();
      if (further >= distance[j]) continue;
      distance[j] = further;
      open.emplace(further, j);
    }
  }
  return distance;
}

int nearest_vertex(const TriMesh& mesh, const Vec3& point) {
  Eigen::Index best = 0;
  (mesh.V.rowwise() - point.transpose()).rowwise().squaredNorm().minCoeff(&best);
  return int(best);
}

std::vector<Vec3> middle_line(const TriMesh& mesh, const Vec3& a, const Vec3& b, int count) {
  const auto from_a = edge_distances(mesh, nearest_vertex(mesh, a)),
             from_b = edge_distances(mesh, nearest_vertex(mesh, b));
  const bool joined = std::isfinite(from_b[nearest_vertex(mesh, a)]);
  const auto place = [&](int i) {
    const std::size_t k = i;
    if (joined) return from_a[k] / (from_a[k] + from_b[k]);
    return (Vec3(mesh.V.row(i)) - a).dot(b - a) /
           (b - a).squaredNorm();  // pieces that do not touch: along the straight line
  };
  std::vector<Vec3> sums(count, Vec3::Zero());
  std::vector<double> areas(count, 0.0);
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 p = mesh.V.row(mesh.F(f, 0)), q = mesh.V.row(mesh.F(f, 1)),
               r = mesh.V.row(mesh.F(f, 2));
    const double u = (place(mesh.F(f, 0)) + place(mesh.F(f, 1)) + place(mesh.F(f, 2))) / 3;
    if (!(u >= 0 && u <= 1)) continue;
    const auto band = std::min(std::size_t(u * count), std::size_t(count - 1));
    const double area = (q - p).cross(r - p).norm();
    sums[band] += area * (p + q + r) / 3;
    areas[band] += area;
  }
  std::vector<Vec3> line;
  for (std::size_t k = 0; k < sums.size(); ++k) {
    if (areas[k] > 0) line.push_back(sums[k] / areas[k]);
  }
  return line;
}

}  // namespace ecorche::inline v1
