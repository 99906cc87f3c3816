#include "anatomy/base_mesh/chest_wall.h"

#include <algorithm>
#include <map>
#include <vector>

#include "anatomy/compute/cholesky.h"

namespace ecorche::inline v1 {
namespace {

// What moves breasts alone: the fullest and least firm ones of the package.
constexpr const char* kBreast =
    "breast/female-young-averagemuscle-averageweight-maxcup-minfirmness";
// Of the farthest that a vertex moves: vertices that move less belong to the rim. Larger: some of
// the breast is left; smaller: the patch reaches over the collar bone's hollow and the armpit.
constexpr double kBreastShare = 0.05;

std::vector<int> breast_vertices(const BodyPackage& package) {
  std::vector<int> out;
  const ShapeTarget* target = package.targets ? package.targets->find(kBreast) : nullptr;
  if (target == nullptr) return out;
  const double most = target->offsets.rowwise().norm().maxCoeff();
  for (std::size_t k = 0; k < target->indices.size(); ++k)
    if (target->indices[k] < package.skin_size &&
        target->offsets.row(Eigen::Index(k)).norm() > kBreastShare * most)
      out.push_back(target->indices[k]);
  std::sort(out.begin(), out.end());
  return out;
}

// Rows of the cotangent Laplacian of the undeformed skin, and the area at each vertex.
struct Laplacian {
  std::map<int, std::map<int, double>> rows;
  std::map<int, double> areas;
};

Laplacian laplacian_about(const BodyPackage& package, const std::vector<char>& is_free) {
  const Triangles& F = package.triangles;
  std::vector<char> row(package.skin_size, 0);  // a free vertex has a share in it
  for (Eigen::Index f = 0; f < F.rows(); ++f)
    if (is_free[F(f, 0)] || is_free[F(f, 1)] || is_free[F(f, 2)])
      for (int k = 0; k < 3; ++k) row[F(f, k)] = 1;
  Laplacian out;
  for (Eigen::Index f = 0; f < F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int i = F(f, k), j = F(f, (k + 1) % 3), o = F(f, (k + 2) % 3);
      if (!row[i] && !row[j] && !row[o]) continue;
      const Vec3 a = package.points.row(i) - package.points.row(o),
                 b = package.points.row(j) - package.points.row(o);
      const double twice_area = std::max(a.cross(b).norm(), 1e-12),
                   weight = 0.5 * a.dot(b) / twice_area;
      for (const auto& [own, other] : {std::pair(i, j), std::pair(j, i)}) {
        if (!row[own]) continue;
        out.rows[own][own] += weight;
        out.rows[own][other] -= weight;
      }
      if (row[i]) out.areas[i] += twice_area / 6;
    }
  return out;
}

}  // namespace

TriMesh chest_wall_skin(const BodyPackage& package, Sex sex, const Points& V) {
  TriMesh out = capped_skin(package, V);
  if (sex != Sex::female) return out;
  const std::vector<int> free = breast_vertices(package);
  if (free.empty()) return out;
  std::vector<char> is_free(package.skin_size, 0);
  std::vector<int> column(package.skin_size, -1);
  for (std::size_t k = 0; k < free.size(); ++k) is_free[free[k]] = 1, column[free[k]] = int(k);
  const Laplacian laplacian = laplacian_about(package, is_free);
  const auto unknowns = Eigen::Index(free.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(unknowns, 3);
  for (const auto& [vertex, row] : laplacian.rows) {
    const double weight = 1 / laplacian.areas.at(vertex);
    Vec3 known = Vec3::Zero();
    for (const auto& [other, value] : row)
      if (!is_free[other]) known += value * V.row(other).transpose();
    for (const auto& [one, value] : row) {
      if (!is_free[one]) continue;
      b.row(column[one]) -= weight * value * known.transpose();
      for (const auto& [two, second] : row)
        if (is_free[two]) A(column[one], column[two]) += weight * value * second;
    }
  }
  const Eigen::MatrixXd patch = CholeskyFactor(A).solve_columns(b);
  for (std::size_t k = 0; k < free.size(); ++k) out.V.row(free[k]) = patch.row(Eigen::Index(k));
  return out;
}

}  // namespace ecorche::inline v1
