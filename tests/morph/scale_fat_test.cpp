// Fat made thicker in all and by site: the skin keeps its thickness, a site's factor holds there
// and not far away, and nothing is changed where nothing is asked.
#include "morph/fat/scale_fat.h"

#include <gtest/gtest.h>

namespace ecorche {
namespace {

// A plane that faces up, 60 cm long, with a site at either end.
struct Plane {
  TriMesh skin;
  FatLayer layer;

  Plane() {
    constexpr int columns = 61;
    skin.V.resize(2 * columns, 3);
    skin.F.resize(2 * (columns - 1), 3);
    for (int i = 0; i < columns; ++i) {
      skin.V.row(2 * i) = Vec3(0.01 * i, 0, 0);
      skin.V.row(2 * i + 1) = Vec3(0.01 * i, 0, -0.01);
    }
    for (int i = 0; i + 1 < columns; ++i) {
      skin.F.row(2 * i) << 2 * i, 2 * i + 2, 2 * i + 1;
      skin.F.row(2 * i + 1) << 2 * i + 1, 2 * i + 2, 2 * i + 3;
    }
    layer.thickness.assign(std::size_t(skin.V.rows()), 0.012f);
    layer.over_muscles = layer.thickness;
    layer.skin.assign(layer.thickness.size(), 0.002f);
    layer.sites = {{"belly_l", Vec3(0, 0, 0), Vec3::UnitY()},
                   {"back", Vec3(0.6, 0, 0), Vec3::UnitY()}};
  }
};

TEST(ScaleFat, TheSkinKeepsItsThickness) {
  Plane plane;
  scale_fat(2, {}, plane.skin, plane.layer);
  for (const float thickness : plane.layer.thickness) EXPECT_NEAR(thickness, 0.022, 1e-6);
  EXPECT_EQ(plane.layer.over_muscles, plane.layer.thickness);
}

TEST(ScaleFat, NothingAskedChangesNothing) {
  Plane plane;
  const std::vector<float> before = plane.layer.thickness;
  scale_fat(1, {{"belly", 1}}, plane.skin, plane.layer);
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_NEAR(plane.layer.thickness[i], before[i], 1e-8);
}

TEST(ScaleFat, ASitesFactorHoldsThereAndFadesAway) {
  Plane plane;
  scale_fat(1, {{"belly", 2}}, plane.skin, plane.layer);
  EXPECT_NEAR(plane.layer.thickness.front(), 0.022, 2e-4);
  EXPECT_NEAR(plane.layer.thickness.back(), 0.012, 1e-6);
  for (std::size_t i = 2; i < plane.layer.thickness.size(); i += 2)
    EXPECT_LE(plane.layer.thickness[i], plane.layer.thickness[i - 2] + 1e-9f);
  Plane other;
  scale_fat(1, {{"belly_r", 2}}, other.skin, other.layer);
  EXPECT_NEAR(other.layer.thickness.front(), 0.012, 1e-8) << "the other side's site alone";
}

TEST(ScaleFat, WhatFacesAwayIsLeft) {
  Plane plane;
  plane.layer.sites[0].normal = -Vec3::UnitY();
  scale_fat(1, {{"belly", 2}}, plane.skin, plane.layer);
  EXPECT_NEAR(plane.layer.thickness.front(), 0.012, 1e-8);
}

}  // namespace
}  // namespace ecorche
