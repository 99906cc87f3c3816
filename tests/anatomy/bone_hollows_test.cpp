#include "anatomy/bones/bone_hollows.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "anatomy/bones/bone_package.h"
#include "anatomy/errors.h"

namespace ecorche {
namespace {

// A ball of 80 mm about the mid-plane at the height of a metre.
Bone ball(const std::string& name) {
  constexpr int kRings = 40, kSpokes = 80;
  Bone bone;
  bone.name = name;
  bone.mesh.V.resize((kRings + 1) * kSpokes, 3);
  bone.mesh.F.resize(2 * kRings * kSpokes, 3);
  int face = 0;
  for (int r = 0; r <= kRings; ++r)
    for (int s = 0; s < kSpokes; ++s) {
      const double polar = std::numbers::pi * (r + 0.001) / (kRings + 0.002),
                   turn = 2 * std::numbers::pi * s / kSpokes;
      const int v = r * kSpokes + s, next = r * kSpokes + (s + 1) % kSpokes;
      bone.mesh.V.row(v) =
          Eigen::RowVector3d(kSourceMidPlane + 0.08 * std::sin(polar) * std::cos(turn),
                             1 + 0.08 * std::cos(polar), 0.08 * std::sin(polar) * std::sin(turn));
      if (r == kRings) continue;
      bone.mesh.F.row(face++) << v, next, v + kSpokes;
      bone.mesh.F.row(face++) << next, next + kSpokes, v + kSpokes;
    }
  return bone;
}

constexpr const char* kHead = "hollow,bone,depth_mm,rim_mm,left_mm,up_mm,front_mm\n";
constexpr const char* kSquare =
    "dent,ball,6,10,70,970,-30\ndent,ball,6,10,70,970,30\ndent,ball,6,10,70,1030,30\ndent,ball,6,"
    "10,70,1030,-30\n";

TEST(BoneHollows, GoInByTheirDepthOnBothSidesAndEndAtTheRim) {
  std::vector<Bone> bones{ball("ball")};
  const Points before = bones[0].mesh.V;
  press_hollows(Table(std::string(kHead) + kSquare, "hollows"), bones);
  double deepest[2] = {0, 0};
  for (Eigen::Index v = 0; v < before.rows(); ++v) {
    const Vec3 moved = bones[0].mesh.V.row(v) - before.row(v);
    const double left = before(v, 0) - kSourceMidPlane;
    if (std::abs(before(v, 1) - 1) >= 0.03 || std::abs(before(v, 2)) >= 0.03) {
      EXPECT_EQ(moved.norm(), 0);
    }
    EXPECT_NEAR(moved.tail<2>().norm(), 0, 1e-12) << "a square rim's normal is the sideways axis";
    EXPECT_LE(moved.x() * left, 0) << "nothing goes out";
    deepest[left < 0] = std::max(deepest[left < 0], std::abs(moved.x()));
  }
  EXPECT_NEAR(deepest[0], 0.006, 1e-9);
  EXPECT_NEAR(deepest[1], 0.006, 1e-9);
}

TEST(BoneHollows, WithoutRowsNothingMoves) {
  std::vector<Bone> bones{ball("ball")};
  const Points before = bones[0].mesh.V;
  press_hollows(Table(kHead, "hollows"), bones);
  EXPECT_EQ(bones[0].mesh.V, before);
}

TEST(BoneHollows, NameWhatIsWrong) {
  std::vector<Bone> bones{ball("ball")};
  const auto says = [&](const std::string& rows, const std::string& what) {
    try {
      press_hollows(Table(kHead + rows, "hollows"), bones);
      ADD_FAILURE() << "expected: " << what;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
    }
  };
  says("dent,cube,6,10,70,970,-30\ndent,cube,6,10,70,970,30\ndent,cube,6,10,70,1030,30\n",
       "unknown bone 'cube'");
  says("dent,ball,6,10,70,970,-30\ndent,ball,6,10,70,970,30\n", "has 2 points");
}

}  // namespace
}  // namespace ecorche
