// Local pushes bring bones below the skin, palpable points to their depths and ribs below shoulder
// blades, and fold nothing.
#include "morph/placement/settle_bones.h"

#include <gtest/gtest.h>

#include <cmath>

#include "anatomy/geometry/mesh_measures.h"
#include "tests/morph/shapes.h"

namespace ecorche {
namespace {

constexpr double kSkin = 0.05;  // m, radius of a limb about the y axis

SettledPart shaft(double radius, const Vec3& at) {
  SettledPart part;
  part.bones.emplace_back(cylinder(radius, 0.1, 0.3).V.rowwise() + at.transpose());
  return part;
}

double furthest(const Points& V) { return V.leftCols<1>().cwiseAbs().maxCoeff(); }

TEST(SettleBones, PushesInsideWhatSticksOutAndFoldsNothing) {
  const SkinField skin(cylinder(kSkin, 0, 0.4));
  std::vector<SettledPart> parts{shaft(0.02, Vec3(0.035, 0, 0))};  // 5 mm outside on one side
  const Points before = parts[0].bones[0];
  settle_bones(skin, 0, {}, parts);
  EXPECT_EQ(parts[0].outside, 0);
  EXPECT_LT(parts[0].furthest, 0);
  EXPECT_FALSE(parts[0].pushes.empty());
  for (Eigen::Index i = 0; i < before.rows(); ++i) {
    EXPECT_LT(skin.distance(parts[0].bones[0].row(i)), 0);
    EXPECT_LT((pushed(parts[0].pushes, 0, before.row(i)) - Vec3(parts[0].bones[0].row(i))).norm(),
              1e-12);
  }
  TriMesh bone = cylinder(0.02, 0.1, 0.3);
  const Points old = vertex_normals({before, bone.F}),
               now = vertex_normals({parts[0].bones[0], bone.F});
  EXPECT_GT(old.cwiseProduct(now).rowwise().sum().minCoeff(), 0);
}

TEST(SettleBones, LeavesAloneWhatIsInside) {
  const SkinField skin(cylinder(kSkin, 0, 0.4));
  std::vector<SettledPart> parts{shaft(0.02, Vec3(0.02, 0, 0))};
  const Points before = parts[0].bones[0];
  settle_bones(skin, 0, {{0, Vec3(0.04, 0.2, 0), 5e-3, 15e-3}}, parts);
  EXPECT_TRUE(parts[0].pushes.empty());
  EXPECT_EQ(parts[0].bones[0], before);
}

TEST(SettleBones, BringsPalpablePointsToTheirDepth) {
  const SkinField skin(cylinder(kSkin, 0, 0.4));
  for (const double depth : {4e-3, 14e-3}) {  // 10 mm are there
    std::vector<SettledPart> parts{shaft(0.02, Vec3(0.02, 0, 0))};
    const Vec3 point = parts[0].bones[0].row(20 * 96);
    settle_bones(skin, 0, {{0, point, depth - 1e-3, depth + 1e-3}}, parts);
    EXPECT_NEAR(-skin.distance(pushed(parts[0].pushes, 0, point)), depth, 1.1e-3);
  }
  // what is off by centimetres stays
  std::vector<SettledPart> parts{shaft(0.02, Vec3(0.005, 0, 0))};
  settle_bones(skin, 0, {{0, parts[0].bones[0].row(20 * 96), 2e-3, 4e-3}}, parts);
  EXPECT_TRUE(parts[0].pushes.empty());
}

TEST(SettleBones, EvenBonesStayEven) {
  const SkinField skin(cylinder(kSkin, 0, 0.4));
  std::vector<SettledPart> parts{shaft(0.052, Vec3::Zero())};
  parts[0].even = true;
  settle_bones(skin, 0, {}, parts);
  const Points& V = parts[0].bones[0];
  EXPECT_LT(furthest(V), kSkin);
  constexpr int kAround = 96;
  for (Eigen::Index i = 0; i + 2 < V.rows(); ++i) {
    const Eigen::Index k = i % kAround, other = i - k + (kAround + kAround / 2 - k) % kAround;
    EXPECT_NEAR(V(i, 0), -V(other, 0), 1e-9);
    EXPECT_NEAR(V(i, 1), V(other, 1), 1e-9);
    EXPECT_NEAR(V(i, 2), V(other, 2), 1e-9);
  }
}

// A plate over a cage, half of it within, from `inner` to 4 mm farther out.
TriMesh plate(double inner) {
  TriMesh out{Points(8, 3), Triangles(12, 3)};
  for (int i = 0; i < 8; ++i)
    out.V.row(i) << inner + (i & 1 ? 4e-3 : 0), i & 2 ? 0.2 : 0.1, i & 4 ? 0.03 : -0.03;
  out.F << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6,
      1, 3, 5, 3, 7, 5;
  return out;
}

TEST(KeepBelow, RibsGiveWayToABladeAndOnlyThere) {
  constexpr double kCage = 0.12, kClearance = 3e-3;  // m
  const TriMesh cage = cylinder(kCage, 0, 0.3);
  for (const double inner : {0.114, 0.1185, 0.1215}) {  // around the cage's wall, through it, above
    SettledPart part;
    part.bones = {cage.V};
    keep_below(plate(inner), 0, kClearance, part);
    const Points& V = part.bones[0];
    for (Eigen::Index i = 0; i < V.rows(); ++i) {
      const Vec3 before = cage.V.row(i), now = V.row(i);
      EXPECT_LE(now.head<1>().norm(), before.head<1>().norm() + 1e-9);
      EXPECT_LT((pushed(part.pushes, 0, before) - now).norm(), 1e-12);
      if (before.x() < 0) EXPECT_EQ(before, now);
      const bool under = now.x() > 0 && std::abs(now.z()) < 0.025 && now.y() > 0.1 && now.y() < 0.2;
      if (under) EXPECT_LT(now.x(), inner - kClearance + 0.5e-3) << inner;
    }
    const Points old = vertex_normals(cage), turned = vertex_normals({V, cage.F});
    EXPECT_GT(old.cwiseProduct(turned).rowwise().sum().minCoeff(), 0);
  }
}

TEST(KeepBelow, LeavesAloneWhatIsFarEnough) {
  SettledPart part;
  part.bones = {cylinder(0.12, 0, 0.3).V};
  keep_below(plate(0.125), 0, 3e-3, part);
  EXPECT_TRUE(part.pushes.empty());
}

}  // namespace
}  // namespace ecorche
