#include "anatomy/posing/symmetrize_outlines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/slice_outline.h"

namespace ecorche {
namespace {

// Sections on a quarter of a circle of this radius about the origin; every width axis points to the
// middle.
std::vector<Ellipse> bend(double radius, double inward) {
  std::vector<Ellipse> out;
  constexpr int kSections = 9;
  for (int k = 0; k < kSections; ++k) {
    const double angle = 1.5707963 * k / (kSections - 1);
    Ellipse e;
    const Vec3 from(std::cos(angle), std::sin(angle), 0),
        along(-std::sin(angle), std::cos(angle), 0);
    e.center = radius * from;
    e.axes.col(0) = -from;
    e.axes.col(2) = along;
    e.axes.col(1) = along.cross(-from);
    e.radii = Vec2(0.01, 0.01);
    for (std::size_t i = 0; i < e.outline.size(); ++i)
      e.outline[i] = outline_directions()[i].x() > 0.5 ? float(inward) : 0.6f;
    out.push_back(e);
  }
  return out;
}

double most_without(const std::vector<Ellipse>& strip) {
  double most = 0;
  for (double g = 0.4; g <= 3; g += 0.01) {
    std::vector<Ellipse> grown = strip;
    for (Ellipse& e : grown) e.radii *= g;
    most = std::max(most, tube_volume(grown));
  }
  return most;
}

TEST(RoundOut, GivesTheVolumeThatLeaningOutlinesCannotHold) {
  const std::vector<Ellipse> given = bend(0.02, 2.4);
  const std::vector<float> belly(given.size(), 1);
  const BellyScaling law{belly, true, 1.0 / 3, 3};
  const double wanted = 1.05 * most_without(given);
  std::vector<Ellipse> strip = given;
  const double growth = symmetrize_outlines(strip, law, wanted);
  EXPECT_NEAR(tube_volume(strip) / wanted, 1, 1e-9);
  EXPECT_GT(growth, 1);
  EXPECT_LT(growth, 3);
  EXPECT_GT(strip[4].outline[0], strip[4].outline[kOutlinePoints / 2]);  // it leans still
}

TEST(RoundOut, OutlinesAreNoMoreEvenThanTheVolumeTakes) {
  const std::vector<Ellipse> given = bend(0.02, 2.4);
  const std::vector<float> belly(given.size(), 1);
  const double most = most_without(given);
  float before = given[4].outline[0];
  for (int k = 1; k <= 20; ++k) {
    std::vector<Ellipse> strip = given;
    symmetrize_outlines(strip, {belly, true, 1.0 / 3, 3}, (1.05 + 2e-4 * k) * most);
    const float now = strip[4].outline[0];
    EXPECT_LT(now, before) << k;
    if (k > 1) {
      EXPECT_GT(now, before - 1e-3f) << k;
    }
    before = now;
  }
}

TEST(RoundOut, LeavesOutlinesThatCanHoldIt) {
  const std::vector<Ellipse> given = bend(0.2, 1.2);
  const std::vector<float> belly(given.size(), 1);
  std::vector<Ellipse> strip = given;
  const double wanted = 1.2 * tube_volume(given);
  symmetrize_outlines(strip, {belly, true, 1.0 / 3, 3}, wanted);
  EXPECT_NEAR(tube_volume(strip) / wanted, 1, 1e-9);
  for (std::size_t k = 0; k < strip.size(); ++k) EXPECT_EQ(strip[k].outline, given[k].outline);
}

// A straight line of round sections, belly in the middle third; its tendons 30 times as thick as
// it.
struct Strip {
  std::vector<Ellipse> sections;
  std::vector<float> belly;
};
Strip thin_belly() {
  Strip out;
  for (int k = 0; k < 10; ++k) {
    Ellipse e;
    e.center = Vec3(0, 0, 0.01 * k);
    const bool fleshy = k >= 4 && k < 6;
    e.radii = fleshy ? Vec2(0.0001, 0.0001) : Vec2(0.003, 0.003);
    out.sections.push_back(e);
    out.belly.push_back(fleshy ? 1 : 0);
  }
  return out;
}

TEST(RoundOut, TendonsTakeWhatTheBellyCannot) {
  const Strip given = thin_belly();
  const BellyScaling law{given.belly, true, 1.0 / 3, 3};
  for (const double share : {0.5, 0.9, 1.3, 2.0}) {
    std::vector<Ellipse> strip = given.sections;
    const double wanted = share * tube_volume(given.sections);
    const double growth = symmetrize_outlines(strip, law, wanted);
    EXPECT_NEAR(tube_volume(strip) / wanted, 1, 1e-9) << share;
    EXPECT_NEAR(growth, share < 1 ? 1.0 / 3 : 3, 1e-9) << "the belly stays at the end of its range";
    EXPECT_GT((strip[0].radii.x() - 0.003) * (share - 1), 0);
  }
}

TEST(RoundOut, TendonsSetInWithoutAJump) {
  const Strip given = thin_belly();
  const BellyScaling law{given.belly, true, 1.0 / 3, 3};
  std::vector<Ellipse> fullest = given.sections;
  for (std::size_t k = 0; k < fullest.size(); ++k)
    fullest[k].radii *= 1 + 2 * double(given.belly[k]);
  const double most = tube_volume(fullest);
  for (const double over : {-1e-5, 1e-5}) {
    std::vector<Ellipse> strip = given.sections;
    symmetrize_outlines(strip, law, (1 + over) * most);
    for (std::size_t k = 0; k < strip.size(); ++k)
      EXPECT_NEAR(strip[k].radii.x() / fullest[k].radii.x(), 1, 1e-2) << over << " section " << k;
  }
}

}  // namespace
}  // namespace ecorche
