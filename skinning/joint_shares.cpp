#include "skinning/joint_shares.h"

#include <tbb/parallel_for.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "anatomy/errors.h"

namespace ecorche {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr double kLeastCotan = 0.02;  // negative cotangents would make shares overshoot

double cotan(const Vec3& a, const Vec3& b) {
  return a.dot(b) / std::max(a.cross(b).norm(), 1e-12);
}

// Cotan Laplacian (positive semi-definite) plus the screening diagonal.
Sparse screened_laplacian(const TriMesh& skin, const Eigen::VectorXd& screen) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(12 * skin.F.rows() + skin.V.rows()));
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int i = skin.F(f, (k + 1) % 3), j = skin.F(f, (k + 2) % 3);
      const Vec3 o = skin.V.row(skin.F(f, k));
      const Vec3 a = skin.V.row(i).transpose() - o, b = skin.V.row(j).transpose() - o;
      const double w = std::max(0.5 * cotan(a, b), kLeastCotan);
      entries.emplace_back(i, i, w);
      entries.emplace_back(j, j, w);
      entries.emplace_back(i, j, -w);
      entries.emplace_back(j, i, -w);
    }
  for (Eigen::Index i = 0; i < screen.size(); ++i) entries.emplace_back(i, i, screen[i]);
  Sparse A(skin.V.rows(), skin.V.rows());
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

Eigen::VectorXd vertex_areas(const TriMesh& skin) {
  Eigen::VectorXd areas = Eigen::VectorXd::Constant(skin.V.rows(), 1e-12);
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f) {
    const Vec3 a = skin.V.row(skin.F(f, 0)), b = skin.V.row(skin.F(f, 1)), c = skin.V.row(skin.F(f, 2));
    const double third = (b - a).cross(c - a).norm() / 6;
    for (int k = 0; k < 3; ++k) areas[skin.F(f, k)] += third;
  }
  return areas;
}

}  // namespace

std::vector<ShareRow> diffuse_shares(const TriMesh& skin, const SkinSurvey& survey, int joint_count, double blend_width) {
  const Eigen::Index n = skin.V.rows();
  std::vector<std::vector<int>> members(static_cast<std::size_t>(joint_count));
  for (Eigen::Index i = 0; i < n; ++i)
    if (const int j = survey.joint[static_cast<std::size_t>(i)]; j >= 0) members[static_cast<std::size_t>(j)].push_back(static_cast<int>(i));
  std::vector<int> used;
  for (int j = 0; j < joint_count; ++j)
    if (!members[static_cast<std::size_t>(j)].empty()) used.push_back(j);
  if (used.empty()) throw UnfitError("skin: no vertex has a bone beneath it; is the anatomy inside this skin?");

  // Half the radius and a little of the depth: the inside of a bent limb needs l > 0.5 * radius * angle to stay unfolded.
  Eigen::VectorXd screen = vertex_areas(skin);  // M / l^2 where the label counts
  Eigen::VectorXd anchor = screen;
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const double length = blend_width * (0.4 * survey.radius[k] + 0.25 * std::min(survey.depth[k], 2 * survey.radius[k]));
    screen[i] /= length * length;
    anchor[i] = survey.joint[k] >= 0 ? screen[i] : 1e-6 * screen[i];
  }
  const Eigen::SimplicialLDLT<Sparse> first(screened_laplacian(skin, anchor));
  const Eigen::SimplicialLDLT<Sparse> second(screened_laplacian(skin, screen));

  std::vector<Eigen::VectorXd> shares(used.size());
  tbb::parallel_for(std::size_t{0}, used.size(), [&](std::size_t u) {
    Eigen::VectorXd target = Eigen::VectorXd::Zero(n);
    for (int i : members[static_cast<std::size_t>(used[u])]) target[i] = anchor[i];
    const Eigen::VectorXd once = first.solve(target);
    shares[u] = second.solve(screen.cwiseProduct(once));
  });
  std::vector<ShareRow> rows(static_cast<std::size_t>(n));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    double sum = 0;
    for (std::size_t u = 0; u < used.size(); ++u) {
      const double w = shares[u][static_cast<Eigen::Index>(i)];
      if (w < 1e-4) continue;
      rows[i].push_back({used[u], w});
      sum += w;
    }
    for (Influence& influence : rows[i]) influence.weight /= sum;
  }
  return rows;
}

void thin_shares(std::vector<ShareRow>& rows, double least, int most) {
  for (ShareRow& row : rows) {
    double largest = 0;
    for (const Influence& w : row) largest = std::max(largest, w.weight);
    double cut = std::min(least, 0.5 * largest);
    if (static_cast<int>(row.size()) > most) {
      std::vector<double> sorted;
      for (const Influence& w : row) sorted.push_back(w.weight);
      std::nth_element(sorted.begin(), sorted.begin() + most, sorted.end(), std::greater<>());
      cut = std::max(cut, sorted[static_cast<std::size_t>(most)]);
    }
    double sum = 0;
    for (Influence& w : row) sum += w.weight = std::max(0.0, w.weight - cut);
    std::erase_if(row, [](const Influence& w) { return w.weight <= 0; });
    for (Influence& w : row) w.weight /= sum;
  }
}

}  // namespace ecorche
