// Volumes of what solids share, against shapes whose overlap has a formula; inside and outside of
// points.
#include "anatomy/geometry/overlap_volumes.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "anatomy/geometry/mesh_measures.h"

using namespace ecorche;

namespace {

TriMesh box(const Vec3& low, const Vec3& high) {
  TriMesh mesh;
  mesh.V.resize(8, 3);
  for (int i = 0; i < 8; ++i)
    mesh.V.row(i) =
        Vec3(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z());
  mesh.F.resize(12, 3);
  mesh.F << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4,
      6, 1, 3, 5, 3, 7, 5;
  return mesh;
}

TriMesh ball_solids(const Vec3& center, double radius) {
  constexpr int rows = 64, around = 128;
  TriMesh mesh;
  mesh.V.resize((rows - 1) * around + 2, 3);
  for (int r = 1; r < rows; ++r)
    for (int k = 0; k < around; ++k) {
      const double t = std::numbers::pi * r / rows, p = 2 * std::numbers::pi * k / around;
      mesh.V.row((r - 1) * around + k) =
          center +
          radius * Vec3(std::sin(t) * std::cos(p), std::cos(t), -std::sin(t) * std::sin(p));
    }
  const int top = (rows - 1) * around, bottom = top + 1;
  mesh.V.row(top) = center + Vec3(0, radius, 0);
  mesh.V.row(bottom) = center - Vec3(0, radius, 0);
  std::vector<Eigen::RowVector3i> faces;
  for (int k = 0; k < around; ++k) {
    const int n = (k + 1) % around;
    faces.push_back({top, k, n});
    faces.push_back({bottom, (rows - 2) * around + n, (rows - 2) * around + k});
    for (int r = 0; r + 2 < rows; ++r) {
      faces.push_back({r * around + k, (r + 1) * around + k, r * around + n});
      faces.push_back({(r + 1) * around + k, (r + 1) * around + n, r * around + n});
    }
  }
  mesh.F.resize(int(faces.size()), 3);
  for (std::size_t i = 0; i < faces.size(); ++i) mesh.F.row(int(i)) = faces[i];
  return mesh;
}

Solid solid(const TriMesh& mesh, Solid::Kind kind) {
  return {kind, &mesh.V, &mesh.F, 0, int(mesh.F.rows())};
}

}  // namespace

TEST(Solids, ShapesOfTheTestAreClosedAndFaceOut) {
  EXPECT_NEAR(mesh_volume(box({0, 0, 0}, {1, 2, 3})), 6, 1e-12);
  EXPECT_TRUE(is_closed(box({0, 0, 0}, {1, 2, 3}).F));
  EXPECT_NEAR(mesh_volume(ball_solids({0, 0, 0}, 1)), 4.0 / 3 * std::numbers::pi, 0.01);
}

TEST(Solids, BoxesShareWhatTheirFacesSay) {
  const TriMesh a = box({0, 0, 0}, {0.1, 0.1, 0.1}), b = box({0.06, 0.02, 0.05}, {0.2, 0.08, 0.2}),
                bone = box({0.01, 0.01, 0.01}, {0.03, 0.03, 0.2});
  const std::vector<Solid> solids{solid(a, Solid::Kind::muscle), solid(b, Solid::Kind::muscle),
                                  solid(bone, Solid::Kind::bone)};
  const SolidVolumes v = measure_solids(solids, 0.0005);
  EXPECT_NEAR(v.volume[0], 1e-3, 1e-6);
  EXPECT_NEAR(v.volume[1], 0.14 * 0.06 * 0.15, 1e-6);
  const double shared = 0.04 * 0.06 * 0.05, in_bone = 0.02 * 0.02 * 0.09;
  EXPECT_NEAR(v.muscle_excess, shared, 2e-6);
  EXPECT_NEAR(v.in_muscle[0], shared, 2e-6);
  EXPECT_NEAR(v.in_muscle[1], shared, 2e-6);
  EXPECT_NEAR(v.muscle_bone, in_bone, 1e-6);
  EXPECT_NEAR(v.in_bone[0], in_bone, 1e-6);
  EXPECT_EQ(v.in_bone[1], 0);
  EXPECT_NEAR(v.muscles, v.volume[0] + v.volume[1] - shared, 2e-6);
  ASSERT_EQ(v.pairs.size(), 2u);
  EXPECT_EQ(v.pairs[0].a, 0);
  EXPECT_EQ(v.pairs[0].b, 1);
  EXPECT_NEAR(v.pairs[0].volume, shared, 2e-6);
  EXPECT_EQ(v.open_columns, 0);
  EXPECT_NEAR(v.muscle_overlap_share(), shared / (v.volume[0] + v.volume[1]), 1e-3);
}

TEST(Solids, BallsShareTheLens) {
  const double r = 0.05, d = 0.06;
  const TriMesh a = ball_solids({0, 0, 0}, r), b = ball_solids({d * 0.6, d * 0.64, d * 0.48}, r);
  const double away = d * Vec3(0.6, 0.64, 0.48).norm();
  const double lens = std::numbers::pi * (4 * r + away) * std::pow(2 * r - away, 2) / 12;
  const SolidVolumes v = measure_solids(
      std::vector<Solid>{solid(a, Solid::Kind::muscle), solid(b, Solid::Kind::muscle)}, 0.001);
  EXPECT_NEAR(v.muscle_excess / lens, 1, 0.01);
  EXPECT_NEAR(v.volume[0] / (4.0 / 3 * std::numbers::pi * r * r * r), 1, 0.005);
}

TEST(Solids, ThreeInOnePlaceCountTwiceTooMuch) {
  const TriMesh a = box({0, 0, 0}, {0.1, 0.1, 0.1});
  const SolidVolumes v =
      measure_solids(std::vector<Solid>(3, solid(a, Solid::Kind::muscle)), 0.001);
  EXPECT_NEAR(v.muscles, 1e-3, 2e-6);
  EXPECT_NEAR(v.muscle_excess, 2e-3, 4e-6);
  EXPECT_EQ(v.pairs.size(), 3u);
}

TEST(Solids, WhatStandsOutOfTheSkin) {
  const TriMesh skin = box({0, 0, 0}, {0.1, 0.1, 0.1}),
                muscle = box({0.05, 0.05, 0.05}, {0.07, 0.13, 0.07});
  const SolidVolumes v = measure_solids(
      std::vector<Solid>{solid(skin, Solid::Kind::skin), solid(muscle, Solid::Kind::muscle)},
      0.0005);
  EXPECT_NEAR(v.outside[1], 0.02 * 0.02 * 0.03, 5e-7);
  const TriMesh inside = box({0.05, 0.05, 0.05}, {0.07, 0.09, 0.07});
  EXPECT_EQ(measure_solids(std::vector<Solid>{solid(skin, Solid::Kind::skin),
                                              solid(inside, Solid::Kind::muscle)},
                           0.0005)
                .outside[1],
            0);
}

TEST(Solids, ATubeThatCrossesItselfCountsOnce) {
  const TriMesh a = box({0, 0, 0}, {0.1, 0.1, 0.1}), b = box({0.05, 0, 0}, {0.15, 0.1, 0.1});
  TriMesh both;
  both.V.resize(16, 3);
  both.V << a.V, b.V;
  both.F.resize(24, 3);
  both.F << a.F, (b.F.array() + 8).matrix();
  const SolidVolumes v =
      measure_solids(std::vector<Solid>{solid(both, Solid::Kind::muscle)}, 0.001);
  EXPECT_NEAR(v.volume[0], 1.5e-3, 3e-6);
  EXPECT_EQ(v.muscle_excess, 0);
}

TEST(Solids, OpenMeshesAreLeftOutAndCounted) {
  TriMesh a = box({0, 0, 0}, {0.1, 0.1, 0.1});
  a.F.conservativeResize(11, 3);
  a.F.row(2) = a.F.row(10);
  const SolidVolumes v = measure_solids(std::vector<Solid>{solid(a, Solid::Kind::muscle)}, 0.001);
  EXPECT_GT(v.open_columns, 0);
  EXPECT_LT(v.volume[0], 1e-3);
  EXPECT_THROW(measure_solids(std::vector<Solid>{solid(a, Solid::Kind::muscle)}, 0),
               std::invalid_argument);
}

TEST(Solids, LinesThroughCornersAndEdgesDoNotLeak) {
  // A grid of points that lie exactly on the corners and edges of the boxes, seen along z.
  const TriMesh a = box({0, 0, 0}, {1, 1, 1});
  Points points(5 * 5 * 3, 3);
  int n = 0;
  for (double x : {-0.5, 0.0, 0.25, 0.5, 0.75})
    for (double y : {-0.5, 0.0, 0.25, 0.5, 0.75})
      for (double z : {-1.0, 0.5, 2.0}) points.row(n++) = Vec3(x, y, z);
  const std::vector<int> winding = winding_numbers(a, points);
  for (int i = 0; i < n; ++i) {
    const bool beyond = points(i, 2) != 0.5 || points(i, 0) < 0 || points(i, 1) < 0;
    const bool within = !beyond && points(i, 0) > 0 && points(i, 1) > 0;
    if (beyond || within) {
      EXPECT_EQ(winding[i], within ? 1 : 0) << points.row(i);
    }
  }
}

TEST(Solids, PointsOfABallAreInsideByTheirDistance) {
  const TriMesh mesh = ball_solids({0.1, 0.2, 0.3}, 0.5);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> spread(-0.8, 0.8);
  Points points(4000, 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    points.row(i) = Vec3(0.1, 0.2, 0.3) + Vec3(spread(random), spread(random), spread(random));
  const std::vector<int> winding = winding_numbers(mesh, points);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const double distance = (points.row(i).transpose() - Vec3(0.1, 0.2, 0.3)).norm();
    if (std::abs(distance - 0.5) < 1e-3) continue;
    EXPECT_EQ(winding[i], distance < 0.5 ? 1 : 0) << distance;
  }
}
