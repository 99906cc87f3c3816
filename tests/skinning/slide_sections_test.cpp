// Laws of sections that slide along their strip: what has not been stretched stays, ends stay, a
// gap that has opened is shared, sections stay on their line and in their order.
#include "skinning/interior/slide_sections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace ecorche {
namespace {

constexpr double kReach = 0.06;
constexpr std::size_t kSections = 21;

// On a straight line, `gaps` apart; the axes' first entry says where a section was, m.
std::vector<MappedSection> straight(std::span<const double> gaps) {
  std::vector<MappedSection> out(gaps.size() + 1);
  double along = 0;
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k].center = Vec3(along, 0, 0);
    out[k].axes(0, 0) = along;
    if (k < gaps.size()) along += gaps[k];
  }
  return out;
}

// Uneven gaps at rest, and the same with one that has opened five times.
std::vector<double> rest_gaps() {
  std::vector<double> out(kSections - 1);
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = 0.008 + 0.006 * double(k % 3);
  return out;
}

std::vector<double> opened_gaps() {
  std::vector<double> out = rest_gaps();
  out[12] *= 5;
  return out;
}

// What sliding makes least, by its definition. `gaps`: at rest.
double strain(std::span<const double> gaps, std::span<const MappedSection> was,
              std::span<const MappedSection> now) {
  double out = 0;
  for (std::size_t k = 0; k + 1 < was.size(); ++k) {
    const double gap = now[k + 1].center.x() - now[k].center.x();
    const double wanted =
        std::clamp(was[k + 1].center.x() - was[k].center.x(), 0.8 * gaps[k], 1.25 * gaps[k]);
    out += std::pow(gap - wanted, 2) / gaps[k];
  }
  for (std::size_t k = 1; k + 1 < was.size(); ++k)
    out += std::pow((now[k].center.x() - was[k].center.x()) / kReach, 2) * 0.5 *
           (gaps[k - 1] + gaps[k]);
  return out;
}

TEST(SlideSections, LeaveTheRestPose) {
  const std::vector<double> gaps = rest_gaps();
  const std::vector<MappedSection> rest = straight(gaps);
  std::vector<MappedSection> strip = rest;
  slide_sections(gaps, kReach, strip);
  for (std::size_t k = 0; k < strip.size(); ++k) {
    EXPECT_LT((strip[k].center - rest[k].center).norm(), 1e-12) << k;
    EXPECT_LT((strip[k].axes - rest[k].axes).norm(), 1e-12) << k;
  }
}

TEST(SlideSections, ShareAGapThatHasOpened) {
  const std::vector<double> gaps = rest_gaps();
  const std::vector<MappedSection> was = straight(opened_gaps());
  std::vector<MappedSection> strip = was;
  slide_sections(gaps, kReach, strip);
  EXPECT_EQ(strip.front().center, was.front().center);
  EXPECT_EQ(strip.back().center, was.back().center);
  double most = 0;
  for (std::size_t k = 0; k + 1 < strip.size(); ++k) {
    const double gap = strip[k + 1].center.x() - strip[k].center.x();
    EXPECT_GT(gap, 0.9 * gaps[k]) << k;
    most = std::max(most, gap / gaps[k]);
  }
  EXPECT_LT(most, 1.8);  // of 5
  // No section can move and make it less.
  const double least = strain(gaps, was, strip);
  for (std::size_t k = 1; k + 1 < strip.size(); ++k)
    for (const double step : {-1e-4, 1e-4}) {
      std::vector<MappedSection> other = strip;
      other[k].center.x() += step;
      EXPECT_GT(strain(gaps, was, other), least) << k;
    }
}

TEST(SlideSections, TakeTheAxesOfWhereTheyGo) {
  std::vector<MappedSection> strip = straight(opened_gaps());
  slide_sections(rest_gaps(), kReach, strip);
  for (std::size_t k = 0; k < strip.size(); ++k)
    EXPECT_NEAR(strip[k].axes(0, 0), strip[k].center.x(), 1e-12) << k;
}

TEST(SlideSections, StayOnABentLine) {
  constexpr double kRadius = 0.05;
  const std::vector<double> gaps(kSections - 1, 0.5 * std::numbers::pi * kRadius / kSections);
  std::vector<MappedSection> strip(kSections);
  double angle = 0;
  for (std::size_t k = 0; k < kSections; ++k) {
    strip[k].center = kRadius * Vec3(std::cos(angle), std::sin(angle), 0);
    angle += (k == 12 ? 5 : 1) * gaps[0] / kRadius;
  }
  slide_sections(gaps, kReach, strip);
  for (std::size_t k = 0; k < kSections; ++k)
    EXPECT_NEAR(strip[k].center.norm(), kRadius, 2e-4) << k;
}

}  // namespace
}  // namespace ecorche
