// Laws of muscles lifted off bones: out of bone, all sections of a tube on one side.
#include "morph/dilation/lift_off_bones.h"

#include <gtest/gtest.h>

#include "anatomy/muscles/action_line.h"
#include "tests/anatomy/strips.h"
#include "tests/morph/shapes.h"

namespace ecorche {
namespace {

constexpr double kBarRadius = 0.008;  // m, of a bone along x through (0, 1.15, 0)

Anatomy tube_through_bar() {
  Anatomy out;
  Muscle& muscle = out.muscles.emplace_back();
  muscle.name = "tube";
  muscle.strips = {testing::straight_strap({0, 1, 0}, {0, 1.3, 0}, 31, {0.002, 0.002})};
  Bone& bone = out.bones.emplace_back();
  bone.name = "bar";
  bone.mesh = cylinder(kBarRadius, -0.1, 0.1);
  for (Eigen::Index v = 0; v < bone.mesh.V.rows(); ++v) {
    const Vec3 p = bone.mesh.V.row(v);
    bone.mesh.V.row(v) = Vec3(p.y(), 1.15 + p.z(), p.x());
  }
  return out;
}

TEST(LiftOffBones, ATubePassesOnOneSide) {
  Anatomy anatomy = tube_through_bar();
  std::vector<Ellipse> slices = rest_slices(anatomy);
  // Of three that go through the bar two are nearer to its front, the one between to its back.
  for (std::size_t k = 14; k <= 16; ++k) slices[k].center.z() = k == 15 ? -0.002 : 0.001;
  lift_off_bones(anatomy.muscles, slices, rest_slices(anatomy), std::vector<int>{-1},
                 make_bone_rays(anatomy, {}), SkinRays(cylinder(0.2, 0.8, 1.5)));
  for (std::size_t k = 14; k <= 16; ++k) {
    EXPECT_GT(slices[k].center.z() * slices[15].center.z(), 0) << k;
    EXPECT_GT(std::hypot(slices[k].center.y() - 1.15, slices[k].center.z()), kBarRadius) << k;
    EXPECT_NEAR(slices[k].center.x(), 0, 1e-3) << k;
  }
  for (const std::size_t k : {0, 5, 25, 30}) EXPECT_NEAR(slices[k].center.z(), 0, 1e-6) << k;
}

// Pressed beyond the bar's middle, a section comes back to the side where it was carried.
TEST(LiftOffBones, ATubeGoesBackWhereItCameFrom) {
  Anatomy anatomy = tube_through_bar();
  std::vector<Ellipse> carried = rest_slices(anatomy);
  for (std::size_t k = 13; k <= 17; ++k) carried[k].center.z() = 0.01;
  std::vector<Ellipse> slices = carried;
  slices[15].center.z() = -0.002;
  lift_off_bones(anatomy.muscles, slices, carried, std::vector<int>{-1},
                 make_bone_rays(anatomy, {}), SkinRays(cylinder(0.2, 0.8, 1.5)));
  EXPECT_GT(slices[15].center.z(), kBarRadius);
}

}  // namespace
}  // namespace ecorche
