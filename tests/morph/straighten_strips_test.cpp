// Laws of strips made straight: one that turns aside and back does so no more, the rest stays, to
// the last digit.
#include "morph/dilation/straighten_strips.h"

#include <gtest/gtest.h>

#include <cmath>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/torn_muscles.h"
#include "anatomy/muscles/transform_muscles.h"
#include "tests/anatomy/strips.h"

namespace ecorche {
namespace {

std::vector<Muscle> strap_straighten() {
  Muscle muscle;
  muscle.name = "strap";
  muscle.strips = {testing::straight_strap({0, 1, 0}, {0, 1.3, 0}, 21, {0.02, 0.01})};
  return {muscle};
}

std::vector<Ellipse> sections_straighten(const std::vector<Muscle>& muscles) {
  Anatomy anatomy;
  anatomy.muscles = muscles;
  return rest_slices(anatomy);
}

// The strap with a bump of `height` (m) over 6 cm of its middle.
std::vector<Muscle> bumped(double height) {
  std::vector<Muscle> muscles = strap_straighten();
  std::vector<Ellipse> slices = sections_straighten(muscles);
  for (int k = -2; k <= 2; ++k)
    slices[std::size_t(10 + k)].center.z() += height * (1 - std::abs(k) / 3.0);
  set_slices(muscles[0].strips[0], slices);
  return muscles;
}

TEST(StraightenStrips, WhatTurnsAsideAndBackDoesSoNoMore) {
  const std::vector<Muscle> reference = strap_straighten();
  std::vector<Muscle> bent = bumped(0.04);
  ASSERT_TRUE(is_torn(measure_tears(bent, reference)[0]));
  std::vector<Ellipse> slices = sections_straighten(bent);
  const std::vector<Ellipse> before = slices;
  EXPECT_EQ(straighten_strips(bent, reference, std::vector<int>{-1}, slices), 1);
  for (std::size_t k = 0; k < slices.size(); ++k) {
    EXPECT_NEAR(slices[k].center.y(), before[k].center.y(), 1e-12) << k;  // in its plane
    EXPECT_EQ(slices[k].radii, before[k].radii) << k;
    if (k < 5 || k > 15) EXPECT_EQ(slices[k].center, before[k].center) << k;
  }
  set_slices(bent[0].strips[0], slices);
  EXPECT_LT(measure_tears(bent, reference)[0].kink, 0.011);
}

// A gentle bend; what bends in the reference, too; a mirror image; other sections.
TEST(StraightenStrips, TheRestStays) {
  const std::vector<Muscle> straight = strap_straighten(), gentle = bumped(0.008),
                            bent = bumped(0.04);
  std::vector<Muscle> shorter = straight;
  shorter[0].strips[0].slices.pop_back();
  const auto stays = [](const std::vector<Muscle>& muscles, const std::vector<Muscle>& reference,
                        int partner) {
    std::vector<Ellipse> slices = sections_straighten(muscles);
    const std::vector<Ellipse> before = slices;
    EXPECT_EQ(straighten_strips(muscles, reference, std::vector<int>{partner}, slices), 0);
    for (std::size_t k = 0; k < slices.size(); ++k) EXPECT_EQ(slices[k].center, before[k].center);
  };
  stays(gentle, straight, -1);
  stays(bent, bent, -1);
  stays(bent, straight, 0);
  stays(bent, shorter, -1);
}

}  // namespace
}  // namespace ecorche
