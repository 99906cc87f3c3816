// Laws of foot contacts: when a foot touches the ground and leaves it does not depend on the rate
// of the frames.
#include "skinning/constraints/foot_contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace ecorche;

namespace {

constexpr double kTouch = 0.413, kLeave = 0.977, kEnd = 1.5;  // s

// A foot that comes from behind and above, stands, and goes on.
Vec3 foot_at(double t) {
  const double away = t < kTouch ? t - kTouch : std::max(0.0, t - kLeave);
  return {0, 0.9 * away * away, 6 * away * std::abs(away)};
}

std::vector<Interval> standing_at(double fps) {
  std::vector<Vec3> path;
  for (int f = 0; f <= int(kEnd * fps); ++f) path.push_back(foot_at(f / fps));
  return standing_intervals(path, std::vector<double>(path.size(), 0.0), fps);
}

}  // namespace

// A point that comes near the ground, but not so near that it stands for certain, stands where
// another of its foot does for as long as a contact takes.
TEST(FootContacts, WhatIsLowBesideAStandingPointStands) {
  const std::vector<Vec3> path(61, Vec3(0, 0.03, 0));
  const std::vector<double> floor(path.size(), 0.0);
  EXPECT_TRUE(standing_intervals(path, floor, 60).empty());
  const std::vector<Interval> heel = {{20, 30}}, brief = {{20, 23}};
  const std::vector<Interval> found = standing_intervals(path, floor, 60, heel);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].begin, 0);
  EXPECT_EQ(found[0].end, 61);
  EXPECT_TRUE(standing_intervals(path, floor, 60, brief).empty());
  const std::vector<Vec3> high(61, Vec3(0, 0.05, 0));
  EXPECT_TRUE(standing_intervals(high, floor, 60, heel).empty());
}

TEST(FootContacts, BeginAndEndBetweenFrames) {
  const std::vector<Interval> exact = standing_at(2400);
  ASSERT_EQ(exact.size(), 1u);
  const double onset = exact[0].onset() / 2400, lift = exact[0].lift() / 2400;
  EXPECT_NEAR(onset, kTouch, 0.06);
  EXPECT_NEAR(lift, kLeave, 0.06);
  for (const double fps : {24.0, 29.97, 60.0, 240.0}) {
    const std::vector<Interval> found = standing_at(fps);
    ASSERT_EQ(found.size(), 1u) << fps;
    EXPECT_NEAR(found[0].onset() / fps, onset, 0.008) << fps;
    EXPECT_NEAR(found[0].lift() / fps, lift, 0.008) << fps;
    EXPECT_GE(found[0].early, 0);
    EXPECT_LT(found[0].early, 1);
    EXPECT_GE(found[0].late, 0);
    EXPECT_LT(found[0].late, 1);
  }
}

// A foot that is shifted slowly while it stands does not stand between its two places.
TEST(FootContacts, AShiftedFootStandsInTwoPlaces) {
  constexpr double kShift = 0.08, kFrom = 0.5, kTo = 0.7;  // m, s
  for (const double fps : {24.0, 60.0, 120.0}) {
    std::vector<Vec3> path;
    for (int f = 0; f <= int(1.2 * fps); ++f)
      path.emplace_back(kShift * std::clamp((f / fps - kFrom) / (kTo - kFrom), 0.0, 1.0), 0, 0);
    const std::vector<Interval> found =
        standing_intervals(path, std::vector<double>(path.size(), 0.0), fps);
    ASSERT_EQ(found.size(), 2u) << fps;
    EXPECT_NEAR(found[0].lift() / fps, kFrom, 0.04) << fps;
    EXPECT_NEAR(found[1].onset() / fps, kTo, 0.04) << fps;
  }
}
