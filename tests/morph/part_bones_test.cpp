// Bones that lie in one another are parted, both give way, and nothing else moves.
#include "morph/placement/part_bones.h"

#include <gtest/gtest.h>

#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/queries/signed_distance.h"
#include "tests/anatomy/ball.h"

namespace ecorche {
namespace {

constexpr double kRadius = 0.02;  // m

Bone ball_at(const std::string& name, Side side, const Vec3& centre) {
  Bone bone{name, side, 0, test::ball(3)};
  bone.mesh.V = kRadius * bone.mesh.V;
  bone.mesh.V.rowwise() += centre.transpose();
  return bone;
}

// m, of the vertex of `a` that lies deepest in `b`; negative where they are apart.
double depth(const Bone& a, const Bone& b) {
  const SkinField field(b.mesh);
  double deepest = -1;
  for (Eigen::Index i = 0; i < a.mesh.V.rows(); ++i)
    deepest = std::max(deepest, -field.distance(a.mesh.V.row(i)));
  return deepest;
}

TEST(PartBones, PartsWhatLiesInOneAnother) {
  std::vector<Bone> bones{ball_at("femur_l", Side::left, {0.1, 0, 0}),
                          ball_at("patella_l", Side::left, {0.1, 0, 0.034}),
                          ball_at("tibia_l", Side::left, {0.1, -0.05, 0})};
  const std::vector<Bone> before = bones;
  ASSERT_GT(depth(bones[0], bones[1]), 5e-3);
  part_bones(bones, {}, std::nullopt);
  EXPECT_LT(depth(bones[0], bones[1]), 0.3e-3);
  EXPECT_LT(depth(bones[1], bones[0]), 0.3e-3);
  for (const int b : {0, 1}) {
    const Points moved = bones[b].mesh.V - before[b].mesh.V;
    EXPECT_GT(moved.rowwise().norm().maxCoeff(), 2e-3);  // both give way
    const SkinField own(before[b].mesh);                 // and none grows
    for (Eigen::Index i = 0; i < moved.rows(); ++i)
      EXPECT_LT(own.distance(bones[b].mesh.V.row(i)), 1e-6);
    EXPECT_GT(mesh_volume(bones[b].mesh), 0.85 * mesh_volume(before[b].mesh));
  }
  EXPECT_EQ(bones[2].mesh.V, before[2].mesh.V);
}

TEST(PartBones, KeepsTheSidesImagesOfEachOther) {
  constexpr double kPlane = 0.01;
  std::vector<Bone> bones{ball_at("sacrum", Side::middle, {kPlane, 0, 0}),
                          ball_at("hip_bone_l", Side::left, {kPlane + 0.035, 0, 0}),
                          ball_at("hip_bone_r", Side::right, {kPlane - 0.035, 0, 0})};
  bones[2].mesh.V = bones[1].mesh.V;
  bones[2].mesh.V.col(0) = 2 * kPlane - bones[2].mesh.V.col(0).array();
  bones[2].mesh.F.col(1).swap(bones[2].mesh.F.col(2));
  part_bones(bones, {}, kPlane);
  EXPECT_LT(depth(bones[0], bones[1]), 0.3e-3);
  EXPECT_LT(depth(bones[0], bones[2]), 0.3e-3);
  Points image = bones[1].mesh.V;
  image.col(0) = 2 * kPlane - image.col(0).array();
  EXPECT_EQ(image, bones[2].mesh.V);
}

TEST(PartBones, LeavesAloneWhatTheReferenceShares) {
  std::vector<Bone> bones{ball_at("talus_l", Side::left, {0.1, 0, 0}),
                          ball_at("calcaneus_l", Side::left, {0.1, -0.036, 0})};
  const std::vector<Bone> before = bones;
  part_bones(bones, before, std::nullopt);
  EXPECT_EQ(bones[0].mesh.V, before[0].mesh.V);
  bones[1] = ball_at("calcaneus_l", Side::left, {0.1, -0.033, 0});  // deeper by 3 mm
  part_bones(bones, before, std::nullopt);
  EXPECT_LT(depth(bones[0], bones[1]), depth(before[0], before[1]) + 0.3e-3);
}

TEST(PartBones, LeavesTeethBetweenOneAnother) {
  std::vector<Bone> bones{ball_at("skull", Side::middle, {0, 0, 0}),
                          ball_at("mandible", Side::middle, {0, -0.036, 0})};
  const Points before = bones[0].mesh.V;
  part_bones(bones, {}, std::nullopt);
  EXPECT_EQ(bones[0].mesh.V, before);
}

}  // namespace
}  // namespace ecorche
