// Laws of bone surfaces: whatever a package's mesh lacks, a closed surface with its outside outside
// comes back, rounder than coarse triangles and no finer than shows.
#include "anatomy/bones/bone_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "anatomy/geometry/mesh_measures.h"
#include "tests/anatomy/ball.h"

namespace ecorche {
namespace {

TriMesh ball(double radius, int rounds) {
  TriMesh out = test::ball(rounds);
  out.V *= radius;
  return out;
}

double largest_departure(const TriMesh& ball, double radius) {
  double worst = 0;
  for (Eigen::Index f = 0; f < ball.F.rows(); ++f) {
    const Vec3 middle =
        (ball.V.row(ball.F(f, 0)) + ball.V.row(ball.F(f, 1)) + ball.V.row(ball.F(f, 2))) / 3;
    worst = std::max(worst, std::abs(middle.norm() - radius));
  }
  return worst;
}

TEST(BoneSurface, KeepsVerticesOfCoarseBonesAndRoundsWhatLiesBetween) {
  const TriMesh coarse = ball(0.05, 1);
  const TriMesh bone = rounded_bone(coarse);
  EXPECT_EQ(bone.F.rows(), 4 * coarse.F.rows());
  EXPECT_TRUE(is_closed(bone.F));
  EXPECT_LT(largest_departure(bone, 0.05), 0.5 * largest_departure(coarse, 0.05));
  EXPECT_EQ(bone.V.topRows(coarse.V.rows()), coarse.V);
  const TriMesh fine = ball(0.05, 3);
  EXPECT_TRUE(rounded_bone(fine).F == fine.F) << "fine enough";
}

TEST(BoneSurface, ClosesHolesAndTurnsTrianglesAlike) {
  TriMesh torn = ball(0.05, 2);
  const double volume = mesh_volume(torn);
  for (Eigen::Index f = 0; f < torn.F.rows(); f += 3) torn.F.row(f).reverseInPlace();
  torn.F.conservativeResize(torn.F.rows() - 7, 3);
  ASSERT_FALSE(is_closed(torn.F));
  const TriMesh bone = closed_bone(torn);
  EXPECT_TRUE(is_closed(bone.F));
  EXPECT_NEAR(mesh_volume(bone), volume, 0.03 * volume);
}

TEST(BoneSurface, SimplifiesWhatIsFinerThanShows) {
  const double radius = 0.01;
  const TriMesh fine = ball(radius, 4);
  const TriMesh bone = closed_bone(fine);
  EXPECT_LT(bone.F.rows(), fine.F.rows() / 4);
  EXPECT_TRUE(is_closed(bone.F));
  EXPECT_NEAR(mesh_volume(bone), 4.0 / 3 * std::numbers::pi * std::pow(radius, 3),
              0.02 * mesh_volume(bone));
}

}  // namespace
}  // namespace ecorche
