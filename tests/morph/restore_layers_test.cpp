// Laws of layers restored: a rib, or a muscle of a deeper layer, that has come through a
// superficial one lies under it again; what lies in order, deeper muscles and mirror images stay as
// they are.
#include "morph/dilation/restore_layers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"
#include "tests/anatomy/strips.h"
#include "tests/morph/shapes.h"

namespace ecorche {
namespace {

constexpr double kSkinRadius = 0.06, kLayer = 0.005, kRibRadius = 0.005;  // m

// A limb's skin; a rib across it towards +x, and a strap along it, their axes at x.
struct RibScene {
  Anatomy anatomy;
  SkinRays skin{cylinder(kSkinRadius, -0.3, 0.3)};
  FatLayer fat;

  RibScene(double rib, double strap, const char* layer, const char* bone = "rib4_l") {
    Bone& one = anatomy.bones.emplace_back();
    one.name = bone;
    one.mesh = cylinder(kRibRadius, -0.025, 0.025, 24, 12);
    for (Eigen::Index i = 0; i < one.mesh.V.rows(); ++i) {
      const Vec3 p = one.mesh.V.row(i);
      one.mesh.V.row(i) << rib + p.x(), -p.z(), p.y();
    }
    Muscle& muscle = anatomy.muscles.emplace_back();
    muscle.name = "strap";
    muscle.layer = layer;
    muscle.strips = {testing::straight_strap({strap, -0.1, 0}, {strap, 0.1, 0}, 21, {0.004, 0.02})};
    fat.thickness.assign(std::size_t(skin.mesh().V.rows()), float(kLayer));
  }

  std::vector<Ellipse> restored(int partner = -1) {
    std::vector<Ellipse> slices = rest_slices(anatomy);
    restore_layers(anatomy, slices, std::vector<int>{partner}, skin, fat);
    return slices;
  }
};

// How far the drawn muscle goes towards +x, above the middle of the rib.
double height_over_rib(const Anatomy& anatomy, std::span<const Ellipse> slices) {
  const MuscleSurface surface = make_muscle_surface(anatomy);
  Points positions;
  update_muscle_surface(surface, slices, positions);
  double out = 0;
  for (Eigen::Index i = 0; i < positions.rows(); ++i)
    if (std::abs(positions(i, 1)) < 0.006 && std::abs(positions(i, 2)) < 0.006)
      out = std::max(out, positions(i, 0));
  return out;
}

TEST(RestoreLayers, ASuperficialMuscleComesOverTheRibThatCameThrough) {
  RibScene scene(0.044, 0.043, "superficial");
  const double top = 0.044 + kRibRadius;
  ASSERT_LT(height_over_rib(scene.anatomy, rest_slices(scene.anatomy)), top);
  const double now = height_over_rib(scene.anatomy, scene.restored());
  EXPECT_GT(now, top);
  EXPECT_LT(now, top + 0.005);  // three rounds, and neighbours follow
  EXPECT_LT(now, kSkinRadius - 0.001);
}

TEST(RestoreLayers, WhatLiesInOrderStays) {
  struct Case {
    double rib, strap;
    const char *layer, *bone;
    int partner;
  };
  for (const Case& one :
       {Case{0.03, 0.045, "superficial", "rib4_l", -1},   // well below
        Case{0.044, 0.030, "superficial", "rib4_l", -1},  // far over
        Case{0.044, 0.043, "deep", "rib4_l", -1}, Case{0.044, 0.043, "superficial", "radius_l", -1},
        Case{0.044, 0.043, "superficial", "rib4_l", 0}}) {
    RibScene scene(one.rib, one.strap, one.layer, one.bone);
    const std::vector<Ellipse> before = rest_slices(scene.anatomy),
                               after = scene.restored(one.partner);
    for (std::size_t k = 0; k < before.size(); ++k)
      EXPECT_EQ(before[k].outline, after[k].outline) << one.layer << ' ' << one.bone << ' ' << k;
  }
}

}  // namespace
}  // namespace ecorche
