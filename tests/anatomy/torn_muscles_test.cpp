// Laws of the figure for muscles torn at rest: nothing is torn beside itself, moved or made larger
// alike; rolls of one section beside the next are found, and by name.
#include "anatomy/muscles/torn_muscles.h"

#include <gtest/gtest.h>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/transform_muscles.h"
#include "tests/anatomy/strips.h"

namespace ecorche {
namespace {

std::vector<Muscle> straps_torn_muscles(double length = 0.3) {
  std::vector<Muscle> out;
  for (const char* name : {"one", "other"}) {
    Muscle& muscle = out.emplace_back();
    muscle.name = name;
    muscle.strips = {testing::straight_strap({0, 1, 0}, {0, 1 + length, 0}, 21, {0.04, 0.01})};
  }
  return out;
}

TEST(TornMuscles, NothingIsTornBesideItself) {
  const std::vector<Muscle> reference = straps_torn_muscles();
  std::vector<Muscle> larger = reference;
  for (Muscle& muscle : larger) scale_radii(muscle.strips[0], Vec2::Constant(1.3));
  for (const std::vector<Muscle>& muscles : {reference, larger}) {
    const std::vector<MuscleTear> tears = measure_tears(muscles, reference);
    for (const MuscleTear& tear : tears) {
      EXPECT_TRUE(tear.known);
      EXPECT_EQ(tear.needles, 0);
    }
    EXPECT_TRUE(torn_muscles(tears).empty());
  }
}

TEST(TornMuscles, RollsAreFound) {
  const std::vector<Muscle> reference = straps_torn_muscles();
  std::vector<Muscle> rolled = reference;
  for (std::size_t k = 5; k < 15; k += 2)
    for (float& factor : rolled[1].strips[0].slices[k].outline) factor = 3;
  const std::vector<MuscleTear> tears = measure_tears(rolled, reference);
  EXPECT_EQ(tears[0].needles, 0);
  EXPECT_GT(tears[1].raised, 20);
  EXPECT_GT(tears[1].needle, 0.015);
  EXPECT_EQ(torn_muscles(tears), std::vector<int>{1});
}

// Sections moved along a long strap: its points stand off their neighbours, its surface is the
// same.
TEST(TornMuscles, WhatLiesWithinTheSurfaceIsNotSeen) {
  const std::vector<Muscle> reference = straps_torn_muscles(1.2);
  std::vector<Muscle> moved = reference;
  std::vector<Slice>& slices = moved[0].strips[0].slices;
  for (std::size_t k = 1; k + 1 < slices.size(); ++k) slices[k].s += k % 2 == 0 ? 0.0175 : -0.0175;
  const MuscleTear tear = measure_tears(moved, reference)[0];
  EXPECT_GT(tear.needles, 12);
  EXPECT_LT(tear.raised, 3);
  EXPECT_LT(tear.needle, 0.008);
  EXPECT_FALSE(is_torn(tear));
}

// A strip that turns aside and back by 4 cm. Made twice as long it is no more kinked.
TEST(TornMuscles, KinksAreFound) {
  const std::vector<Muscle> reference = straps_torn_muscles();
  std::vector<Muscle> kinked = reference;
  std::vector<Slice>& slices = kinked[1].strips[0].slices;
  for (std::size_t k = 9; k <= 11; ++k) slices[k].offset.y() += 0.04;
  const std::vector<MuscleTear> tears = measure_tears(kinked, reference);
  EXPECT_LT(tears[0].kink, 1e-6);
  EXPECT_NEAR(tears[1].kink, 0.04, 0.004);
  EXPECT_TRUE(is_torn(tears[1]));
  std::vector<Muscle> longer = straps_torn_muscles(0.6);
  for (std::size_t k = 9; k <= 11; ++k) longer[1].strips[0].slices[k].offset.y() += 0.08;
  EXPECT_LT(measure_tears(longer, kinked)[1].kink, 0.004);
}

// A wide section between narrow ones, in the reference too, stands off its neighbours by more where
// all is larger.
TEST(TornMuscles, LargerMusclesAreAsWhole) {
  std::vector<Muscle> reference = straps_torn_muscles();
  for (Muscle& muscle : reference)
    for (float& factor : muscle.strips[0].slices[10].outline) factor = 1.9f;
  std::vector<Muscle> larger = reference;
  for (Muscle& muscle : larger) scale_radii(muscle.strips[0], Vec2::Constant(1.4));
  for (const MuscleTear& tear : measure_tears(larger, reference)) {
    EXPECT_EQ(tear.needles, 0);
    EXPECT_FALSE(is_torn(tear));
  }
}

TEST(TornMuscles, OthersAreNotKnown) {
  std::vector<Muscle> muscles = straps_torn_muscles();
  const std::vector<Muscle> reference = muscles;
  muscles[0].name = "stranger";
  muscles[1].strips[0].slices.pop_back();
  for (const MuscleTear& tear : measure_tears(muscles, reference)) EXPECT_FALSE(tear.known);
}

}  // namespace
}  // namespace ecorche
