// Laws of walls: a deeper sheet that lies over the one that covers it goes below it, but into no
// bone, one that lies below stays, ends on bones stay, and nothing else moves.
#include "morph/dilation/lay_wall.h"

#include <gtest/gtest.h>

#include "anatomy/muscles/action_line.h"

namespace ecorche {
namespace {

constexpr double kCoverDepth = 0.020;  // m under the skin

TriMesh slab_of_skin() {
  TriMesh out{Points(8, 3), Triangles(12, 3)};
  const Vec3 low(-0.3, -0.3, -0.3), high(0.3, 0.3, 0);
  for (int i = 0; i < 8; ++i)
    out.V.row(i) << (i & 1 ? high : low).x(), (i & 2 ? high : low).y(), (i & 4 ? high : low).z();
  out.F << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6,
      1, 3, 5, 3, 7, 5;
  return out;
}

// Strips along y at these x, so deep under the skin. The cover is a little longer than the others.
Muscle wall_sheet(const std::string& layer, std::initializer_list<double> at, double depth) {
  const double end = layer == "superficial" ? 0.12 : 0.1;
  Muscle out;
  out.name = layer;
  out.group = "trunk_abdomen";
  out.layer = layer;
  out.sheet = true;
  for (const double x : at) {
    Strip& strip = out.strips.emplace_back();
    for (const double y : {-end, 0.0, end}) strip.path.push_back({Vec3(x, y, -depth), {0, -1}, 1});
    strip.reference = Vec3::UnitX();
    for (int k = 0; k <= 20; ++k) {
      Slice& slice = strip.slices.emplace_back();
      slice.s = k / 20.0;
      slice.radii = Vec2(0.015, 0.002);
    }
    strip.rest_length = 2 * end;
  }
  return out;
}

struct Wall {
  Anatomy anatomy;
  std::vector<Ellipse> before, slices;
  SkinRays skin{slab_of_skin()};

  explicit Wall(Muscle inner) {
    anatomy.muscles = {wall_sheet("superficial", {-0.05, 0.05}, kCoverDepth), std::move(inner)};
    for (const Muscle& muscle : anatomy.muscles)
      for (const Strip& strip : muscle.strips)
        for (const Ellipse& slice : rest_slices(strip)) before.push_back(slice);
    slices = before;
  }
  double lay(std::vector<int> partners = {-1, -1}) {
    return lay_wall(anatomy, slices, partners, skin);
  }
  double moved(std::size_t k) const { return (slices[k].center - before[k].center).norm(); }
  static constexpr std::size_t kInner = 42, kEnd = 63;  // slices of the inner sheet
};

TEST(LayWall, InnerSheetsGoBelowTheirCover) {
  Wall wall(wall_sheet("intermediate", {0}, 0.012));
  EXPECT_GT(wall.lay(), 0.01);
  for (std::size_t k = 0; k < Wall::kInner; ++k) EXPECT_EQ(wall.moved(k), 0) << k;
  for (std::size_t k = Wall::kInner; k < Wall::kEnd; ++k) {
    EXPECT_LT(wall.slices[k].center.z() + wall.slices[k].radii.y(), -kCoverDepth - 0.002) << k;
    EXPECT_GT(wall.slices[k].center.z(), -kCoverDepth - 0.006) << k;
  }
}

TEST(LayWall, WhatLiesBelowStays) {
  Wall wall(wall_sheet("intermediate", {0}, 0.026));
  EXPECT_EQ(wall.lay(), 0);
}

TEST(LayWall, EndsOnBonesStay) {
  Muscle inner = wall_sheet("deep", {0}, 0.012);
  inner.origin_bone = "hip_bone_l";
  Wall wall(std::move(inner));
  wall.lay();
  EXPECT_LT(wall.moved(Wall::kInner), 0.004);
  EXPECT_GT(wall.moved(Wall::kEnd - 1), 0.01);
}

Wall wall_of_back(double x) {
  Wall out(wall_sheet("superficial", {x}, 0.012));
  out.anatomy.muscles[0].name = "trapezius_lower_l";
  out.anatomy.muscles[1].name = "latissimus_dorsi_thoracic_l";
  for (Muscle& muscle : out.anatomy.muscles) muscle.group = "trunk_shoulder";
  return out;
}

TEST(LayWall, SheetsOfTheBackGoBelowTheTrapezius) {
  Wall wall = wall_of_back(0);
  EXPECT_GT(wall.lay(), 0.01);
  wall.slices = wall.before;
  wall.anatomy.muscles[0].group = "trunk_abdomen";  // the belly's wall is another
  EXPECT_EQ(wall.lay(), 0);
}

// There the cover is as wide as it is drawn, 15 mm beyond its last line; the belly's ends at it.
TEST(LayWall, SheetsOfTheBackGoBelowTheEdgeToo) {
  EXPECT_GT(wall_of_back(0.07).lay(), 0.01);
  EXPECT_EQ(wall_of_back(0.09).lay(), 0);
  EXPECT_EQ(Wall(wall_sheet("intermediate", {0.07}, 0.012)).lay(), 0);
}

TEST(LayWall, SheetsAreNotLaidIntoBones) {
  TriMesh bone = slab_of_skin();
  bone.V.col(2).array() -= 0.018;
  Wall wall(wall_sheet("intermediate", {0}, 0.012));
  wall.anatomy.bones.push_back({"scapula_l", Side::left, 0, bone});
  const BoneRays bones = make_bone_rays(wall.anatomy, std::nullopt);
  EXPECT_NEAR(lay_wall(wall.anatomy, wall.slices, std::vector<int>{-1, -1}, wall.skin, &bones),
              0.004, 1e-5);
}

TEST(LayWall, OtherMusclesAndMirrorImagesStay) {
  Muscle other = wall_sheet("intermediate", {0}, 0.012);
  other.group = "thigh";
  Wall wall(std::move(other));
  EXPECT_EQ(wall.lay(), 0);
  Wall mirrored(wall_sheet("intermediate", {0}, 0.012));
  EXPECT_EQ(mirrored.lay({-1, 0}), 0);
}

}  // namespace
}  // namespace ecorche
