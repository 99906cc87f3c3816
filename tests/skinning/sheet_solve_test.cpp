// Laws of the linear algebra and of the searches beneath the elastic skin, against other ways to
// the same answers.
#include <gtest/gtest.h>

#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/SparseCholesky>

#include "anatomy/geometry/vertex_normals.h"
#include "anatomy/queries/nearest_surface.h"
#include "skinning/muscle_collision/project_to_skin.h"
#include "skinning/settle/sparse_solver.h"
#include "tests/skinning/arm.h"

namespace ecorche {
namespace {

// A sphere with poles of 20 triangles, longer than eight, and bumps.
TriMesh bumpy_sphere(int sides) {
  std::vector<Vec2> profile;
  for (int k = 1; k < 16; ++k)
    profile.emplace_back(-0.1 * std::cos(k * 0.19635), 0.1 * std::sin(k * 0.19635));
  TriMesh out = test::lathe(Vec3(3, -2, 5), Vec3::UnitY(), profile, sides);
  for (Eigen::Index i = 0; i < out.V.rows(); ++i) {
    const Vec3 p = Vec3(out.V.row(i)) - Vec3(3, -2, 5);
    out.V.row(i) += (0.05 * std::sin(40 * p.x()) * std::cos(30 * p.z()) * p).transpose();
  }
  return out;
}

// A cross of four grids that meet in the middle, as limbs do.
Eigen::SparseMatrix<double> cross_matrix(int width, int length) {
  std::vector<std::array<int, 2>> cells;
  const auto inside = [&](int x, int y) {
    return std::min(std::abs(x), std::abs(y)) <= width &&
           std::max(std::abs(x), std::abs(y)) <= length;
  };
  std::vector<std::vector<int>> number(2 * length + 1, std::vector<int>(2 * length + 1, -1));
  const auto at = [&](int x, int y) -> int& { return number[x + length][y + length]; };
  for (int x = -length; x <= length; ++x)
    for (int y = -length; y <= length; ++y)
      if (inside(x, y)) {
        at(x, y) = cells.size();
        cells.push_back({x, y});
      }
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& [x, y] : cells) {
    double sum = 0.1 + 0.01 * x;
    for (const auto& [u, v] :
         {std::array{x + 1, y}, std::array{x - 1, y}, std::array{x, y + 1}, std::array{x, y - 1}}) {
      if (!inside(u, v)) continue;
      entries.emplace_back(at(x, y), at(u, v), -1);
      sum += 1;
    }
    entries.emplace_back(at(x, y), at(x, y), std::max(sum, 1.0) + 0.5);
  }
  Eigen::SparseMatrix<double> out(cells.size(), Eigen::Index(cells.size()));
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

std::vector<float> right_sides(const SupernodalFactor& factor, const Eigen::MatrixX3d& b) {
  std::vector<float> x(4 * work_rows(factor), 7);  // what is beyond the rows does not count
  for (Eigen::Index i = 0; i < b.rows(); ++i)
    for (Eigen::Index k = 0; k < 4; ++k)
      x[4 * std::size_t(factor.place[i]) + k] = k < 3 ? float(b(i, k)) : 0;
  return x;
}

TEST(SupernodalFactor, SolvesAsADenseSolverDoesWithEveryBranch) {
  const Eigen::SparseMatrix<double> A = cross_matrix(4, 40);
  const SupernodalFactor factor = factor_supernodal(A);
  ASSERT_EQ(factor.rows, A.rows());
  EXPECT_GT(factor.separator, 0);
  EXPECT_LT(factor.separator, factor.rows / 3);
  for (int branch = 0; branch < SupernodalFactor::kSubtrees; ++branch)
    EXPECT_LT(factor.subtree_begin[branch], factor.subtree_begin[branch + 1]) << branch;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  Eigen::MatrixX3d b(A.rows(), 3);
  for (Eigen::Index i = 0; i < b.size(); ++i) b.data()[i] = any(random);
  const Eigen::MatrixX3d wanted = Eigen::MatrixXd(A).llt().solve(b);
  std::vector<float> x = right_sides(factor, b);
  solve_supernodal(factor, x.data());
  for (Eigen::Index i = 0; i < b.rows(); ++i)
    for (Eigen::Index k = 0; k < 3; ++k)
      ASSERT_NEAR(x[4 * std::size_t(factor.place[i]) + k], wanted(i, k), 1e-5) << i;
  const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  std::vector<float> alone = right_sides(factor, b);
  solve_supernodal(factor, alone.data());
  EXPECT_EQ(x, alone);
}

class LiesOnRings : public ::testing::TestWithParam<int> {};

TEST_P(LiesOnRings, AreThoseOfTheNearestPointWhateverTheRingsHold) {
  const TriMesh mesh = bumpy_sphere(GetParam());
  std::vector<float> positions, normals(4 * std::size_t(mesh.V.rows()));
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
    for (Eigen::Index k = 0; k < 4; ++k) positions.push_back(k < 3 ? float(mesh.V(i, k)) : 1);
  vertex_normals(positions, std::span(mesh.F.data(), std::size_t(mesh.F.size())), normals);
  const SkinRings rings = make_skin_rings(mesh);
  const NearestSurface nearest(mesh);
  std::vector<Eigen::Index> corners(mesh.V.rows());
  for (Eigen::Index k = 0; k < mesh.F.size(); ++k) ++corners[mesh.F.data()[k]];
  const Eigen::Index pole = std::max_element(corners.begin(), corners.end()) - corners.begin();
  std::mt19937 random(7);
  std::uniform_int_distribution<Eigen::Index> vertex(0, mesh.V.rows() - 1);
  std::uniform_real_distribution<double> any(-1, 1), height(-0.004, 0.02);
  for (int trial = 0; trial < 64; ++trial) {
    std::array<int, 8> from;
    std::array<Vec3, 8> place;
    Wide3 ways;
    for (std::size_t lane = 0; lane < 8; ++lane) {
      const Eigen::Index start = lane % 2 == 0 ? pole : vertex(random);
      const Vec3 n(normals[4 * start], normals[4 * start + 1], normals[4 * start + 2]);
      const Vec3 way = height(random) * n + 0.004 * Vec3(any(random), any(random), any(random));
      from[lane] = int(start);
      place[lane] = Vec3(mesh.V.row(start)) + way;
      const int k = lane;
      ways.x[k] = float(way.x()), ways.y[k] = float(way.y()), ways.z[k] = float(way.z());
    }
    const SkinProjections lies = project_to_skin(rings, {positions, normals}, ways, from);
    for (std::size_t lane = 0; lane < 8; ++lane) {
      const int k = lane;
      const SurfacePoint hit = nearest.nearest(place[lane]);
      const Vec3 direction(lies.normal.x[k], lies.normal.y[k], lies.normal.z[k]);
      if (lies.height[k] < -kDeepProjection) continue;
      EXPECT_NEAR(lies.height[k], (place[lane] - hit.point).dot(direction), 2e-5)
          << trial << ": from " << from[lane] << " to " << lies.vertex[lane];
      EXPECT_NEAR(direction.norm(), 1, 1e-5);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Rings, LiesOnRings, ::testing::Values(7, 8, 9, 20));

}  // namespace
}  // namespace ecorche
