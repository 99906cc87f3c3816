// Belly and tendon as tables state them are those that pictures show.
#include "anatomy/muscles/belly_length.h"

#include <gtest/gtest.h>

#include "anatomy/posing/pose_anatomy.h"
#include "tests/skinning/arm.h"

namespace ecorche {
namespace {

// Length of the line where belly lies now, by the shares that slices are coloured by.
double shown_belly(const PosedAnatomy& posed) {
  double belly = 0, whole = 0;
  for (std::size_t k = 1; k < posed.slices.size(); ++k) {
    const double piece = (posed.slices[k].center - posed.slices[k - 1].center).norm();
    whole += piece;
    belly += piece * 0.5 * double(posed.belly[k - 1] + posed.belly[k]);
  }
  return belly / whole * posed.lengths[0];
}

TEST(BellyLength, IsWhatIsDrawn) {
  test::Arm arm = test::make_arm();
  Muscle& biceps = arm.anatomy.muscles[0];
  biceps.fibre_length = 0.12;
  Strip& strip = biceps.strips[0];
  strip.belly_begin = 0.25;
  strip.belly_end = 0.75;
  strip.slices.clear();
  for (int k = 0; k < 60; ++k)
    strip.slices.push_back({k / 59.0, 0, Vec2::Zero(), Vec2(0.01, 0.008)});
  const PosingTable table = make_posing_table(arm.anatomy);
  const BellyRestLength share = belly_rest_lengths(arm.anatomy)[0];
  for (const double turn : {0.6, 0.0, -0.8, -1.6})
    for (const double activation : {0.0, 0.3, 1.0}) {
      Pose pose = rest_pose(arm.anatomy.skeleton);
      pose.rotations[3] = Quat(Eigen::AngleAxisd(turn, Vec3::UnitX()));
      PosedAnatomy posed;
      pose_anatomy(table, arm.anatomy.skeleton, pose, posed, 1, std::vector<double>{activation});
      const double length = posed.lengths[0], belly = belly_length(share, length, activation);
      EXPECT_NEAR(belly, shown_belly(posed), 0.02 * length) << turn << ' ' << activation;
      EXPECT_GT(length - belly, 0);
      if (activation > 0) {
        EXPECT_LT(belly, belly_length(share, length, 0));
      }
    }
}

TEST(BellyLength, RestIsTheShareOfTheLine) {
  test::Arm arm = test::make_arm();
  arm.anatomy.muscles[0].strips[0].belly_begin = 0.25;
  const BellyRestLength share = belly_rest_lengths(arm.anatomy)[0];
  EXPECT_NEAR(belly_length(share, share.rest, 0), 0.75 * share.rest, 1e-12);
  EXPECT_NEAR(belly_length(belly_rest_lengths(test::make_arm().anatomy)[0], share.rest, 0),
              share.rest,
              1e-12);  // no tendon: all of it
}

}  // namespace
}  // namespace ecorche
