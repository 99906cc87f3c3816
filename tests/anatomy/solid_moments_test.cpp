// Integrals over solids: boxes, balls and ellipsoids are what books say, a cut adds nothing and
// loses nothing.
#include "anatomy/geometry/solid_moments.h"

#include <gtest/gtest.h>

#include <numbers>

#include "anatomy/geometry/mesh_measures.h"
#include "tests/anatomy/ball.h"

using namespace ecorche;

namespace {

TriMesh box_mesh(const Vec3& size) {
  TriMesh mesh{Points(8, 3), Triangles(12, 3)};
  for (int i = 0; i < 8; ++i) mesh.V.row(i) = Vec3(i & 1, (i >> 1) & 1, i >> 2).cwiseProduct(size);
  mesh.F << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4,
      6, 1, 3, 5, 3, 7, 5;
  return mesh;
}

double difference(const Mat3& a, const Mat3& b) { return (a - b).norm() / b.norm(); }

}  // namespace

TEST(SolidMoments, BoxIsThatOfBooks) {
  const Vec3 size(0.2, 0.3, 0.5), far(3, -2, 1);
  TriMesh mesh = box_mesh(size);
  mesh.V.rowwise() += far.transpose();
  const SolidMoments box = solid_moments(mesh, Vec3(0.1, 7, 2));
  EXPECT_NEAR(box.volume, size.prod(), 1e-12);
  EXPECT_NEAR((box.first / box.volume - far - 0.5 * size).norm(), 0, 1e-12);
  Mat3 expected = Mat3::Zero();
  for (int k = 0; k < 3; ++k)
    expected(k, k) = box.volume / 12 * (size.squaredNorm() - size[k] * size[k]);
  EXPECT_LT(difference(central_inertia(box), expected), 1e-9);
}

TEST(SolidMoments, RoundSolidsAreNear) {
  const Vec3 radii(0.1, 0.25, 0.15), at(0.3, 1.2, -0.4);
  TriMesh mesh = test::ball(3);
  mesh.V = mesh.V * radii.asDiagonal();
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  mesh.V = (mesh.V * turn.transpose()).rowwise() + at.transpose();
  const SolidMoments found = solid_moments(mesh), book = ellipsoid_moments(at, turn, radii);
  EXPECT_NEAR(found.volume / book.volume, 1, 0.02);
  EXPECT_LT((found.first / found.volume - at).norm(), 1e-9);
  EXPECT_LT(difference(central_inertia(found), central_inertia(book)), 0.02);
}

TEST(SolidMoments, CutsShareTheWhole) {
  const TriMesh mesh = test::ball(3);
  const SolidMoments whole = solid_moments(mesh);
  const Vec3 apex(0.2, 0.1, -0.3), normal = Vec3(1, 2, -1).normalized();
  std::vector<double> above, below;
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
    above.push_back((mesh.V.row(v).transpose() - apex).dot(normal));
    below.push_back(-above.back());
  }
  SolidMoments sum = solid_moments_above(mesh, above, apex);
  // a cap of the unit ball, h high
  const double h = 1 - apex.dot(normal), cap = std::numbers::pi * h * h * (3 - h) / 3;
  EXPECT_NEAR(sum.volume / cap, 1, 0.06);
  add_moments(solid_moments_above(mesh, below, apex), 1, sum);
  EXPECT_NEAR(sum.volume, whole.volume, 1e-12);
  EXPECT_LT((sum.first - whole.first).norm(), 1e-12);
  EXPECT_LT((sum.second - whole.second).norm(), 1e-12);
}

TEST(SolidMoments, HalfABoxIsExact) {
  const TriMesh mesh = box_mesh({1, 1, 2});
  std::vector<double> field;
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) field.push_back(mesh.V(v, 2) - 0.5);
  const SolidMoments part = solid_moments_above(mesh, field, {0.3, 9, 0.5});
  EXPECT_NEAR(part.volume, 1.5, 1e-12);
  EXPECT_NEAR(part.first.z() / part.volume, 1.25, 1e-12);
}
