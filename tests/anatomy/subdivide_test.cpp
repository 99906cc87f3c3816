#include "anatomy/geometry/subdivide.h"
#include "anatomy/base_mesh/refined_skin.h"

#include <gtest/gtest.h>

#include <chrono>
#include <set>

#include "anatomy/errors.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/geometry/vertex_order.h"
#include "tests/anatomy/ball.h"
#include "tests/body_fixture.h"

namespace ecorche {
namespace {

TEST(Refine, NineTrianglesForOneAndStaysClosed) {
  const TriMesh coarse = test::octahedron();
  const Refinement fine = refine(coarse.F, 6, 2);
  EXPECT_EQ(fine.F.rows(), 8 * 81);
  EXPECT_EQ(fine.map.rows(), 8 * 81 / 2 + 2);
  EXPECT_TRUE(is_closed(fine.F));
  std::vector<int> children(8, 0);
  for (int p : fine.parents) ++children[p];
  EXPECT_EQ(children, std::vector<int>(8, 81));
}

TEST(Refine, KeepsTheVolumeOfWhatIsRound) {
  const TriMesh sphere = test::ball(2);
  const Refinement fine = refine(sphere.F, int(sphere.V.rows()));
  EXPECT_NEAR(mesh_volume({refine_points(fine, sphere.V), fine.F}) / mesh_volume(sphere), 1, 0.004);
}

TEST(Refine, MovesWithAffineMaps) {
  const TriMesh coarse = test::octahedron();
  const Refinement fine = refine(coarse.F, 6);
  Mat3 A;
  A << 1, 2, 3, 0, 1, 4, -2, 0, 1;
  const Eigen::RowVector3d t(5, 6, 7);
  const Points moved = (coarse.V * A).rowwise() + t;
  const Points expected = (refine_points(fine, coarse.V) * A).rowwise() + t;
  EXPECT_LT((refine_points(fine, moved) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Refine, BoundariesStay) {
  Triangles F(2, 3);
  F << 0, 1, 2, 0, 2, 3;
  Points V(4, 3);
  V << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
  const Refinement fine = refine(F, 4);
  const Points P = refine_points(fine, V);
  EXPECT_NEAR(mesh_area({P, fine.F}), 1, 1e-12);
  EXPECT_LT((P.topRows(4) - V).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Refine, RefusesWhatIsNoManifold) {
  Triangles F(3, 3);
  F << 0, 1, 2, 1, 0, 3, 0, 1, 4;
  EXPECT_THROW(refine(F, 5), UnfitError);
}

TEST(SpatialOrder, IsAPermutationThatKeepsTheMesh) {
  const TriMesh coarse = test::octahedron();
  const Refinement fine = refine(coarse.F, 6, 2);
  const TriMesh before{refine_points(fine, coarse.V), fine.F};
  const auto order = spatial_order(before.V);
  EXPECT_EQ(std::set<int>(order.begin(), order.end()).size(), order.size());
  const TriMesh after = reordered(before, order);
  EXPECT_NEAR(mesh_volume(after), mesh_volume(before), 1e-12);
  double jumps_before = 0, jumps_after = 0;
  for (Eigen::Index i = 1; i < before.V.rows(); ++i) {
    jumps_before += (before.V.row(i) - before.V.row(i - 1)).norm();
    jumps_after += (after.V.row(i) - after.V.row(i - 1)).norm();
  }
  EXPECT_LT(jumps_after, 0.6 * jumps_before);
}

class RefineSkinTest : public BodyFixture {};

TEST_F(RefineSkinTest, IsClosedCloseToTheBaseAndHasItsVolume) {
  const Refinement fine = refine_skin(package());
  EXPECT_EQ(fine.map.rows(), 120404);
  EXPECT_EQ(fine.F.rows(), 9 * 26756);
  EXPECT_TRUE(is_closed(fine.F));
  const Points base = package().points.topRows(package().skin_size);
  const Points P = refine_points(fine, base);
  double sum = 0, worst = 0;
  for (Eigen::Index i = 0; i < base.rows(); ++i) {
    const double d = (P.row(fine.base_rows[i]) - base.row(i)).norm();
    sum += d;
    worst = std::max(worst, d);
  }
  EXPECT_LT(sum / double(base.rows()), 0.6e-3);
  EXPECT_LT(worst, 7e-3);  // inside the mouth
  const double coarse_volume = mesh_volume(capped_skin(package(), base));
  const TriMesh capped = capped_skin(package(), fine, P);
  EXPECT_TRUE(is_closed(capped.F));
  EXPECT_NEAR(mesh_volume(capped) / coarse_volume, 1, 0.001);
  for (Eigen::Index i = 0; i < fine.map.rows(); ++i) ASSERT_NEAR(fine.map.row(i).sum(), 1, 1e-9);
}

}  // namespace
}  // namespace ecorche
