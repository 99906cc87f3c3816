// A head held aside is found by its mirror image, straightened and turned back.
#include "morph/placement/head_turn.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <numeric>

namespace ecorche {
namespace {

constexpr double kLow = 1.4, kHigh = 1.5;  // m, the neck

// Rings about an axis that stands upright, wider in front; every vertex has its mirror image.
struct HeadFigure {
  Points skin;
  std::vector<int> mirror, head;
};

HeadFigure figure() {
  constexpr int kAround = 24, kRings = 30;
  HeadFigure out;
  out.skin.resize(kAround * kRings, 3);
  for (int r = 0; r < kRings; ++r) {
    const double height = 1.2 + 0.02 * r;
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2 * std::numbers::pi * (k + 0.5) / kAround;
      const int i = r * kAround + k;
      out.skin.row(i) << 0.08 * std::sin(angle), height,
          (std::cos(angle) > 0 ? 0.11 : 0.09) * std::cos(angle);
      out.mirror.push_back(r * kAround + kAround - 1 - k);
      if (height > kHigh) out.head.push_back(i);
    }
  }
  return out;
}

TEST(HeadTurn, FindsNoneInAStraightHead) {
  const HeadFigure straight = figure();
  const HeadTurn turn =
      find_head_turn(straight.skin, straight.mirror, straight.head, 0, kLow, kHigh);
  EXPECT_LT(turn.rotation.norm(), 1e-9);
  EXPECT_LT(std::abs(turn.shift), 1e-9);
}

TEST(HeadTurn, IsFoundAndStraightened) {
  const HeadFigure straight = figure();
  HeadTurn held{kLow, kHigh};
  held.centre = Vec3(0, 1.65, 0);
  held.rotation = Vec3(0, 0.25, -0.12);
  held.shift = 0.012;
  Points skin = straight.skin;
  for (Eigen::Index i = 0; i < skin.rows(); ++i) skin.row(i) = held(skin.row(i).transpose());
  const HeadTurn found = find_head_turn(skin, straight.mirror, straight.head, 0, kLow, kHigh);
  EXPECT_NEAR(found.rotation.y(), held.rotation.y(), 0.01);
  EXPECT_NEAR(found.rotation.z(), held.rotation.z(), 0.01);
  const Points back = straightened(found, skin);
  const auto uneven = [&](const Points& V) {
    double most = 0;
    for (const int i : straight.head) {
      const Vec3 other = V.row(straight.mirror[std::size_t(i)]).transpose();
      most = std::max(most,
                      (Vec3(-other.x(), other.y(), other.z()) - Vec3(V.row(i).transpose())).norm());
    }
    return most;
  };
  EXPECT_GT(uneven(skin), 0.02);
  EXPECT_LT(uneven(back), 0.05 * uneven(skin));
  // Below the neck nothing moves, and the turn takes back what it straightened.
  for (Eigen::Index i = 0; i < skin.rows(); ++i) {
    if (skin(i, 1) < kLow - 0.02) {
      EXPECT_EQ(back.row(i), skin.row(i));
    }
    EXPECT_LT((found(back.row(i).transpose()) - Vec3(skin.row(i).transpose())).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace ecorche
