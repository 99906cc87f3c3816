// Laws of what makes planted legs reach: a smooth curve over what they need, and heels that rise.
#include "skinning/constraints/reach_planted.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "skinning/constraints/smooth_above.h"

using namespace ecorche;

namespace {

// A leg that is too short by 15 mm for an instant every 0.6 s.
std::vector<WantedValue> short_legs(double fps) {
  std::vector<WantedValue> out;
  for (int f = 0; f <= int(3 * fps); ++f) {
    const double away = std::abs(std::remainder(f / fps, 0.6));
    out.push_back({0, 1, away < 0.1 ? 0.015 - 0.15 * away : -0.02});
  }
  return out;
}

double fastest_change(const std::vector<double>& values, double fps) {
  double out = 0;
  for (std::size_t f = 1; f + 1 < values.size(); ++f)
    out = std::max(out, std::abs(values[f - 1] - 2 * values[f] + values[f + 1]) * fps * fps);
  return out;
}

}  // namespace

TEST(SmoothAbove, IsAsHighAsItHasToBeAndHardlyHigherNorSudden) {
  for (const double fps : {60.0, 120.0}) {
    const std::vector<WantedValue> wanted = short_legs(fps);
    const std::vector<double> curve = smooth_above(wanted, fps, 0.1);
    double mean = 0;
    for (std::size_t f = 0; f < curve.size(); ++f) {
      EXPECT_GE(curve[f], wanted[f].least);
      EXPECT_LE(curve[f], 0.0165);
      mean += curve[f] / double(curve.size());
    }
    EXPECT_LT(mean, 0.008);
    EXPECT_LT(fastest_change(curve, fps), 2.5);  // m/s^2
  }
}

TEST(SmoothAbove, IsWhatIsWantedWhereNothingHolds) {
  const std::vector<double> curve = smooth_above(std::vector<WantedValue>(50, {0.4, 1}), 60, 0.2);
  for (const double one : curve) EXPECT_NEAR(one, 0.4, 1e-9);
}

// What a heel can do the pelvis need not; where it cannot, the pelvis sinks.
TEST(ReachPlanted, HeelsRiseBeforeThePelvisSinks) {
  constexpr double kFps = 60, kMost = 0.15;
  std::array<std::vector<LegReach>, 2> legs;
  for (auto& leg : legs) leg.assign(181, {});
  for (int f = 80; f <= 100; ++f)
    legs[0][std::size_t(f)] = {.ball = true, .flat = 0.02, .raised = -0.005, .most = kMost};
  const ReachPlan plan = plan_reach(legs, kFps);
  for (const double sunk : plan.sunk) EXPECT_LT(sunk, 0.005);
  for (int f = 80; f <= 100; ++f) {
    const double rise = plan.rise[0][std::size_t(f)];
    EXPECT_GE(plan.sunk[std::size_t(f)] + 0.025 * rise / kMost, 0.02 - 1e-4);
    EXPECT_LE(rise, kMost);
  }
  EXPECT_EQ(plan.rise[0].front(), 0);
  EXPECT_TRUE(std::ranges::all_of(plan.rise[1], [](double one) { return one == 0; }));
  for (auto& one : legs[0]) one.raised = one.flat, one.most = 0;
  const ReachPlan stiff = plan_reach(legs, kFps);
  EXPECT_GE(stiff.sunk[90], 0.02 - 1e-4);
}

// A pelvis whose legs fold no further rises, and no more suddenly than one that sinks.
TEST(ReachPlanted, ThePelvisRisesOverFoldedLegs) {
  constexpr double kFps = 120;
  std::array<std::vector<LegReach>, 2> legs;
  for (auto& leg : legs)
    leg.assign(361, {.heel = true, .ball = true, .flat = -0.3, .raised = -0.3});
  for (int f = 150; f <= 210; ++f) legs[0][std::size_t(f)].folded = 0.08;
  for (int f = 150; f <= 210; ++f) legs[0][std::size_t(f)].bent = 0.2;
  const ReachPlan plan = plan_reach(legs, kFps);
  for (int f = 150; f <= 210; ++f) {
    EXPECT_LE(plan.sunk[std::size_t(f)], -0.08 + 1e-6) << f;
    EXPECT_GE(plan.sunk[std::size_t(f)], -0.10) << f;
    EXPECT_GE(plan.rise[0][std::size_t(f)], 0.2 - 1e-9) << f;
  }
  EXPECT_NEAR(plan.sunk.front(), 0, 0.005);
  EXPECT_LT(fastest_change(plan.sunk, kFps), 6);
  EXPECT_EQ(plan.rise[1][180], 0);
}
