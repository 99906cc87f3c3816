// Laws of what lies in the fat of the skin: it goes with the skin, on bone with what lies inside,
// and with its own of two skins that touch.
#include "anatomy/queries/skin_bonds.h"

#include <gtest/gtest.h>

namespace ecorche {
namespace {

TriMesh plate(double height, bool upwards) {
  TriMesh mesh{Points(4, 3), Triangles(2, 3)};
  mesh.V << -0.1, height, -0.1, 0.1, height, -0.1, 0.1, height, 0.1, -0.1, height, 0.1;
  if (upwards)
    mesh.F << 0, 2, 1, 0, 3, 2;
  else
    mesh.F << 0, 1, 2, 0, 2, 3;
  return mesh;
}

Points upwards(Eigen::Index count) {
  Points normals = Points::Zero(count, 3);
  normals.col(1).setOnes();
  return normals;
}

TEST(SkinBonds, GoWithTheSkinAndOnBoneWithTheInside) {
  const SkinRays skin(plate(0, true));
  const SkinBonder bonder(plate(-0.02, true), skin, upwards(4));
  const auto rise = [&](double depth) {
    const Vec3 p(0.03, -depth, 0.01);
    const SkinBond bond = bonder.bond(p, Vec3::UnitY());
    Vec3 place = 0.007 * Vec3::UnitY();
    for (int k = 0; k < 3; ++k)
      place += bond.weights[k] * Vec3(skin.mesh().V.row(bond.vertices[std::size_t(k)]));
    return Vec3(bond.moved(place, bond.normal, Mat3::Identity(), p) - p);
  };
  EXPECT_LT((rise(0.003) - 0.007 * Vec3::UnitY()).norm(), 1e-6);
  EXPECT_LT(rise(0.0199).norm(), 1e-6);
  EXPECT_GT(rise(0.015).y(), 0.001);
  EXPECT_LT(rise(0.015).y(), 0.006);
}

TEST(SkinBonds, LookThroughAWallThatIsNearerForTheSkinAbove) {
  TriMesh both = plate(0, true);
  const TriMesh wall = plate(-0.002, false);
  both.V.conservativeResize(8, 3);
  both.V.bottomRows(4) = wall.V;
  both.F.conservativeResize(4, 3);
  both.F.bottomRows(2) = (wall.F.array() + 4).matrix();
  const SkinRays skin(both);
  const SkinBond bond = SkinBonder(plate(-0.05, true), skin, upwards(8))
                            .bond(Vec3(0.03, -0.004, 0.01), Vec3::UnitY());
  EXPECT_NEAR(bond.depth, 0.004, 1e-6);
  EXPECT_LT(bond.vertices[0], 4);
}

}  // namespace
}  // namespace ecorche
