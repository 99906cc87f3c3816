// Laws of the line between the lips: it is found where the skin is deepest before the teeth,
// follows the mouth to both sides, and is the teeth's edge where there is no mouth.
#include "anatomy/queries/mouth_line.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "anatomy/compute/smooth_step.h"

namespace ecorche {
namespace {

constexpr double kTeeth = 1.5;  // m up

TriMesh grid(int columns, int rows, const std::function<Vec3(int, int)>& at) {
  TriMesh mesh{Points(columns * rows, 3), grid_triangles(rows, columns)};
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) mesh.V.row(r * columns + c) = at(c, r);
  return mesh;
}

// A face of 120 x 80 mm with a furrow of 4 mm, 50 mm wide, that rises to both sides; flat without.
// `groove`: how far it goes back below the lower lip, 8 to 14 mm below the teeth.
TriMesh face(double depth, double groove = 0) {
  return grid(241, 321, [&](int c, int r) {
    const double x = 0.0005 * (c - 120), y = kTeeth + 0.00025 * (r - 160);
    const double furrow = y - (kTeeth + 0.003 + 2 * x * x);
    const double wide = std::abs(x) < 0.025 ? 1 : 0;
    const double back = groove * smooth_step(0.008, 0.014, kTeeth - y);
    return Vec3(x, y, 0.1 - back - depth * wide * std::exp(-std::pow(furrow / 0.0015, 2)));
  });
}

Anatomy jaw(const char* name) {
  Anatomy out;
  Joint joint;
  joint.name = name;
  out.skeleton.joints = {joint};
  Bone bone;
  bone.name = "mandible";
  bone.mesh = grid(3, 3, [](int c, int r) {
    return Vec3(0.04 * (c - 1), kTeeth - 0.02 * r, r == 0 ? 0.085 : 0.02);
  });
  out.bones = {bone};
  return out;
}

TEST(MouthLine, LiesInTheFurrowFromCornerToCorner) {
  const auto line = find_mouth(jaw("jaw"), face(0.004));
  ASSERT_TRUE(line);
  for (const double x : {0.0, 0.012, -0.02}) {
    EXPECT_TRUE(line->spans(x)) << x;
    EXPECT_NEAR(line->over(Vec3(x, kTeeth + 0.003 + 2 * x * x, 0.1)), 0, 6e-4) << x;
    EXPECT_GT(line->over(Vec3(x, kTeeth + 0.006, 0.1)), 0) << x;
    EXPECT_LT(line->over(Vec3(x, kTeeth, 0.1)), 0) << x;
  }
  EXPECT_FALSE(line->spans(0.03));
  EXPECT_TRUE(line->about(Vec3(0, kTeeth, 0.1)));
  EXPECT_FALSE(line->about(Vec3(0, kTeeth - 0.5, 0.1)));  // feet, too, lie below and in front
  EXPECT_FALSE(line->about(Vec3(0, kTeeth, 0)));
}

TEST(MouthLine, IsNotADeeperGrooveBelowTheLip) {
  const auto line = find_mouth(jaw("jaw"), face(0.004, 0.012));
  ASSERT_TRUE(line);
  EXPECT_NEAR(line->over(Vec3(0, kTeeth + 0.003, 0.1)), 0, 6e-4);
}

TEST(MouthLine, IsTheEdgeOfTheTeethInAFlatFaceAndNoneWithoutAJaw) {
  const auto line = find_mouth(jaw("jaw"), face(0));
  ASSERT_TRUE(line);
  EXPECT_NEAR(line->over(Vec3(0, kTeeth, 0.1)), 0, 1e-9);
  EXPECT_FALSE(line->spans(0.01));
  EXPECT_FALSE(find_mouth(jaw("head"), face(0.004)));
}

}  // namespace
}  // namespace ecorche
