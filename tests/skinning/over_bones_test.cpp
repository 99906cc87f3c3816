// Laws of the skin over bones: at rest nothing moves; a bone that comes out is covered again by the
// skin about it, and the rest of the skin stays where it is.
#include "skinning/muscle_collision/keep_skin_over_bones.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "anatomy/contact/muscle_model.h"
#include "anatomy/geometry/overlap_volumes.h"
#include "anatomy/geometry/vertex_normals.h"
#include "anatomy/posing/pose_anatomy.h"
#include "anatomy/posing/posing_table.h"
#include "tests/anatomy/strips.h"
#include "tests/skinning/arm.h"

namespace ecorche {
namespace {

// A rod of 16 mm in a tube of 30 mm about it, 0.4 m long.
struct Rod {
  Anatomy anatomy;
  TriMesh skin;
  PosedAnatomy rest;
  MuscleCollision collision;

  Rod() {
    anatomy.skeleton = testing::arm_skeleton();
    std::vector<Vec2> rod, tube;
    for (int k = 0; k <= 20; ++k) rod.emplace_back(0.005 * k, k == 0 || k == 20 ? 0.004 : 0.016);
    for (int k = 0; k <= 80; ++k) tube.emplace_back(0.005 * k, k == 0 || k == 80 ? 0.02 : 0.03);
    anatomy.bones.push_back(
        {"rod", Side::middle, 0, test::lathe(Vec3(0, 1.1, 0), Vec3::UnitY(), rod, 24)});
    skin = test::lathe(Vec3(0, 0.95, 0), Vec3::UnitY(), tube, 48);
    const MuscleModel muscles = make_muscle_model(anatomy);
    pose_anatomy(muscles.posing, anatomy.skeleton, rest_pose(anatomy.skeleton), rest);
    collision = make_muscle_collision(anatomy, rest, skin);
  }

  RelaxedSkin at_rest() const {
    RelaxedSkin out;
    for (Eigen::Index v = 0; v < skin.V.rows(); ++v)
      for (int k = 0; k < 4; ++k) out.positions.push_back(k < 3 ? float(skin.V(v, k)) : 1);
    return out;
  }

  // Points of the rod outside the skin, by winding numbers: knows nothing of probes.
  int outside(const RelaxedSkin& posed, const Vec3& shift) const {
    TriMesh shape{skin.V, skin.F};
    for (Eigen::Index v = 0; v < skin.V.rows(); ++v)
      for (int k = 0; k < 3; ++k) shape.V(v, k) = double(posed.positions[4 * v + k]);
    const Points rod = anatomy.bones[0].mesh.V.rowwise() + shift.transpose();
    const std::vector<int> winding = winding_numbers(shape, rod);
    return int(std::count(winding.begin(), winding.end(), 0));
  }
};

TEST(OverBones, AtRestNothingMoves) {
  const Rod rod;
  RelaxedSkin skin = rod.at_rest();
  const std::vector<float> before = skin.positions;
  LiftWorkspace workspace;
  keep_skin_over_bones(rod.collision, rod.rest.X_WJ, skin, workspace);
  EXPECT_EQ(skin.positions, before);
  EXPECT_EQ(skin.normals.size(), before.size());
}

TEST(OverBones, ABoneThatComesOutIsCoveredAndTheRestStays) {
  const Rod rod;
  for (const double by : {0.016, 0.02, 0.03}) {
    const Vec3 shift(by, 0, 0);
    std::vector<Transform> X_WJ = rod.rest.X_WJ;
    for (Transform& X : X_WJ) X.pretranslate(shift);
    RelaxedSkin skin = rod.at_rest();
    const std::vector<float> before = skin.positions;
    ASSERT_GT(rod.outside(skin, shift), 20) << by;
    LiftWorkspace workspace;
    keep_skin_over_bones(rod.collision, X_WJ, skin, workspace);
    EXPECT_EQ(rod.outside(skin, shift), 0) << by;
    std::vector<float> normals(skin.positions.size());
    vertex_normals(skin.positions, std::span(rod.skin.F.data(), std::size_t(rod.skin.F.size())),
                   normals);
    for (std::size_t k = 0; k < normals.size(); ++k)
      EXPECT_NEAR(skin.normals[k], normals[k], 1e-4f);
    for (std::size_t v = 0; v < skin.positions.size(); v += 4)
      if (before[v] < -0.005f || before[v + 1] < 1.05f || before[v + 1] > 1.25f) {
        EXPECT_EQ(skin.positions[v], before[v]);
        EXPECT_EQ(skin.positions[v + 1], before[v + 1]);
      }
  }
}

TEST(OverBones, RefusesWhatBelongsToAnother) {
  const Rod rod;
  LiftWorkspace workspace;
  RelaxedSkin skin = rod.at_rest();
  EXPECT_THROW(keep_skin_over_bones({}, rod.rest.X_WJ, skin, workspace), std::invalid_argument);
  EXPECT_THROW(keep_skin_over_bones(rod.collision, {}, skin, workspace), std::invalid_argument);
  skin.positions.resize(8);
  EXPECT_THROW(keep_skin_over_bones(rod.collision, rod.rest.X_WJ, skin, workspace),
               std::invalid_argument);
}

}  // namespace
}  // namespace ecorche
