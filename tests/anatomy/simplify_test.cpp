// Fewer triangles, the same shape.
#include "anatomy/geometry/simplify.h"

#include <gtest/gtest.h>

#include "anatomy/geometry/mesh_measures.h"
#include "tests/anatomy/ball.h"

namespace ecorche {
namespace {

TEST(Simplify, KeepsTheShapeAndStaysClosed) {
  const TriMesh whole = test::ball(3);  // 5832 triangles
  const TriMesh light = simplify(whole, 400);
  EXPECT_LE(light.F.rows(), 400);
  EXPECT_GT(light.F.rows(), 380);
  EXPECT_TRUE(is_closed(light.F));
  EXPECT_NEAR(mesh_volume(light) / mesh_volume(whole), 1, 0.035)
      << "corners stay on the ball: even triangles of equal size would lack 2.9 %";
  for (Eigen::Index i = 0; i < light.V.rows(); ++i) {
    EXPECT_LT(light.V.row(i).norm(), 1 + 2e-3);
    EXPECT_GT(light.V.row(i).norm(), 0.98);
  }
}

TEST(Simplify, LeavesWhatIsLightAlone) {
  const TriMesh whole = test::ball(1);
  const TriMesh same = simplify(whole, int(whole.F.rows()));
  EXPECT_EQ(same.F, whole.F);
  EXPECT_EQ(same.V, whole.V);
}

TEST(Simplify, TakesMeshesThatMeetInAnEdge) {
  TriMesh two = test::ball(2);
  const Eigen::Index vertices = two.V.rows(), faces = two.F.rows();
  two.F.conservativeResize(faces + 1, 3);
  two.F.row(faces) << two.F(0, 0), two.F(0, 1),
      int(vertices);  // a fin on an edge that has two faces
  two.V.conservativeResize(vertices + 1, 3);
  two.V.row(vertices) << 2, 2, 2;
  const TriMesh light = simplify(two, 200);
  EXPECT_LE(light.F.rows(), 200);
  EXPECT_TRUE(light.V.allFinite());
  EXPECT_LT(light.F.maxCoeff(), light.V.rows());
}

TEST(Simplify, FindsTheNearestRows) {
  const TriMesh whole = test::ball(1);
  const std::vector<int> rows = nearest_rows(1.1 * whole.V, whole.V);
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(rows[i], int(i));
}

}  // namespace
}  // namespace ecorche
