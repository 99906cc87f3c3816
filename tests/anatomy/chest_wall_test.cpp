// Laws of the chest's wall: men's skin is left as it is; women's is bridged beneath the breasts and
// nowhere else, evenly, whatever the breasts are like.
#include "anatomy/base_mesh/chest_wall.h"

#include <gtest/gtest.h>

#include "anatomy/geometry/mesh_measures.h"
#include "tests/body_fixture.h"

namespace ecorche {
namespace {

class ChestWall : public BodyFixture {
 protected:
  // The skin with breasts that move by so much of what the package's fullest ones do.
  static Points skin_with(double share) {
    Points V = package().points.topRows(package().skin_size);
    const ShapeTarget* full = package().targets->find(
        "breast/female-young-averagemuscle-averageweight-maxcup-minfirmness");
    for (std::size_t k = 0; k < full->indices.size(); ++k)
      if (full->indices[k] < package().skin_size)
        V.row(full->indices[k]) += share * full->offsets.row(Eigen::Index(k));
    return V;
  }
};

TEST_F(ChestWall, MenKeepTheirSkin) {
  const Points V = skin_with(0);
  EXPECT_EQ(chest_wall_skin(package(), Sex::male, V).V, capped_skin(package(), V).V);
}

TEST_F(ChestWall, BreastsAreBridged) {
  const Points V = skin_with(1.5);
  const TriMesh skin = capped_skin(package(), V), wall = chest_wall_skin(package(), Sex::female, V);
  EXPECT_EQ(wall.F, skin.F);
  EXPECT_LT(mesh_volume(wall), mesh_volume(skin) - 0.3e-3);
  int moved = 0;
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    const double by = (wall.V.row(i) - skin.V.row(i)).norm();
    moved += by > 0;
    EXPECT_TRUE(by == 0 || std::abs(V(i, 1) - 0.36) < 0.25) << i;
    const Vec3 mirrored = wall.V.row(package().mirror[std::size_t(i)]);
    EXPECT_NEAR(mirrored.x(), -wall.V(i, 0), 1e-5);
    EXPECT_NEAR(mirrored.z(), wall.V(i, 2), 1e-5);
  }
  EXPECT_GT(moved, 200);
  EXPECT_LT(moved, 500);
}

// What is cut out does not matter, but for the rim.
TEST_F(ChestWall, FullBreastsHaveTheWallOfSmallOnes) {
  const TriMesh small = chest_wall_skin(package(), Sex::female, skin_with(0)),
                full = chest_wall_skin(package(), Sex::female, skin_with(2));
  EXPECT_LT((small.V - full.V).rowwise().norm().maxCoeff(), 0.03);
}

}  // namespace
}  // namespace ecorche
