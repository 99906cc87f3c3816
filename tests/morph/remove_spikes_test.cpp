// Laws of spikes taken back: what stands out goes, the rest stays, to the last digit.
#include "morph/dilation/remove_spikes.h"

#include <gtest/gtest.h>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/torn_muscles.h"
#include "anatomy/muscles/transform_muscles.h"
#include "tests/anatomy/strips.h"

namespace ecorche {
namespace {

std::vector<Muscle> strap_remove_spikes() {
  Muscle muscle;
  muscle.name = "strap";
  muscle.strips = {testing::straight_strap({0, 1, 0}, {0, 1.3, 0}, 21, {0.04, 0.02})};
  return {muscle};
}

std::vector<Ellipse> sections(const std::vector<Muscle>& muscles) {
  Anatomy anatomy;
  anatomy.muscles = muscles;
  return rest_slices(anatomy);
}

TEST(RemoveSpikes, WhatStandsOutGoes) {
  const std::vector<Muscle> reference = strap_remove_spikes();
  std::vector<Muscle> spiked = reference;
  for (int i = 0; i < 3; ++i) spiked[0].strips[0].slices[10].outline[i] = 2.5f;
  ASSERT_GT(measure_tears(spiked, reference)[0].needle, 0.025);
  std::vector<Ellipse> slices = sections(spiked);
  const std::vector<Ellipse> before = slices;
  EXPECT_GT(remove_spikes(spiked, reference, std::vector<int>{-1}, slices), 0);
  set_slices(spiked[0].strips[0], slices);
  EXPECT_LT(measure_tears(spiked, reference)[0].needle, 0.015);
  for (std::size_t k = 0; k < slices.size(); ++k)
    for (std::size_t i = 0; i < std::size_t(kOutlinePoints); ++i) {
      EXPECT_LE(slices[k].outline[i], before[k].outline[i]);
      if (k != 10) EXPECT_EQ(slices[k].outline[i], before[k].outline[i]) << k << ' ' << i;
    }
}

// As the reference is, or as a larger one would be; with a dent; in a mirror image.
TEST(RemoveSpikes, TheRestStays) {
  const std::vector<Muscle> reference = strap_remove_spikes();
  std::vector<Muscle> larger = reference, dented = reference, spiked = reference;
  scale_radii(larger[0].strips[0], Vec2::Constant(1.5));
  for (int i = 0; i < 5; ++i) dented[0].strips[0].slices[10].outline[i] = 0.5f;
  for (int i = 0; i < 3; ++i) spiked[0].strips[0].slices[10].outline[i] = 2.5f;
  for (const auto& [muscles, partner] : {std::pair(&larger, -1), {&dented, -1}, {&spiked, 0}}) {
    std::vector<Ellipse> slices = sections(*muscles);
    const std::vector<Ellipse> before = slices;
    EXPECT_EQ(remove_spikes(*muscles, reference, std::vector<int>{partner}, slices), 0);
    for (std::size_t k = 0; k < slices.size(); ++k) EXPECT_EQ(slices[k].outline, before[k].outline);
  }
}

}  // namespace
}  // namespace ecorche
