// Moment arms are what the posed lines shorten by.
#include "anatomy/posing/moment_arms.h"

#include <gtest/gtest.h>

#include "anatomy/posing/pose_anatomy.h"
#include "tests/anatomy/strips.h"

using namespace ecorche;
using namespace ecorche::testing;

namespace {

Anatomy two_muscles() {
  Anatomy anatomy;
  anatomy.skeleton = arm_skeleton();
  Muscle bends, bridges;
  bends.name = "bends";
  bends.strips = {make_strip({on(1, {0.18, 1.40, 0.02}), on(1, {0.18, 1.25, 0.05}),
                              on(2, {0.18, 1.10, 0.03}), on(2, {0.18, 1.05, 0.02})},
                             spindle(9, 0.02, 0.005, 0.2, 0.8, Vec3::UnitX()))};
  bends.strips[0].wraps.push_back(
      {Wrap::Kind::cylinder, 2, Transform::Identity(), {0.02, 0.02, 0.05}});
  bends.strips[0].wraps[0].X_WO.linear() =
      Eigen::AngleAxisd(1.5707963267948966, Vec3::UnitY()).toRotationMatrix();
  bends.strips[0].wraps[0].X_WO.translation() = Vec3(0.18, 1.15, 0.01);
  bridges.name = "bridges";
  bridges.strips = {make_strip(bent_path(), spindle(9, 0.02, 0.005, 0.2, 0.8, Vec3::UnitX()))};
  anatomy.muscles = {bends, bridges};
  return anatomy;
}

}  // namespace

TEST(MomentArms, AreWhatLinesShortenBy) {
  const Anatomy anatomy = two_muscles();
  const PosingTable table = make_posing_table(anatomy);
  const std::vector<TurnAxis> axes{{1, Vec3::UnitX()}, {2, -Vec3::UnitX()}, {4, Vec3::UnitX()}};
  const MomentArms arms(table, anatomy.skeleton, axes);
  // the first strip ends at the elbow; neither reaches the wrist
  ASSERT_FALSE(arms.pairs().empty());
  for (const MomentArm& pair : arms.pairs()) {
    EXPECT_NE(pair.axis, 2);
    EXPECT_FALSE(pair.axis == 0 && pair.strip == 0);
  }
  Pose pose = rest_pose(anatomy.skeleton);
  pose.rotations[2] = Quat(Eigen::AngleAxisd(-0.9, Vec3::UnitX()));
  std::vector<double> lengths;
  std::vector<float> found;
  arms.find(pose, lengths, found);
  PosedAnatomy posed;
  pose_anatomy(table, anatomy.skeleton, pose, posed);
  ASSERT_EQ(lengths.size(), posed.lengths.size());
  for (std::size_t s = 0; s < lengths.size(); ++s) EXPECT_NEAR(lengths[s], posed.lengths[s], 1e-12);
  constexpr double kTurn = 1e-3;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const auto [axis, strip] = arms.pairs()[k];
    const auto length = [&](double angle) {
      Pose turned = pose;
      Quat& q = turned.rotations[axes[std::size_t(axis)].joint];
      q = q * Quat(Eigen::AngleAxisd(angle, axes[std::size_t(axis)].direction));
      pose_anatomy(table, anatomy.skeleton, turned, posed);
      return posed.lengths[std::size_t(strip)];
    };
    EXPECT_NEAR(found[k], (length(-kTurn) - length(kTurn)) / (2 * kTurn), 2e-4) << axis << strip;
    // the first bends the elbow
    EXPECT_TRUE(strip != 0 || axis != 1 || found[k] > 0.02) << found[k];
  }
}
