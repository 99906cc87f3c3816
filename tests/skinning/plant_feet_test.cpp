// Laws of planted feet over a whole walk.
#include "skinning/constraints/plant_feet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <string>

#include "skinning/constraints/foot_contacts.h"
#include "skinning/motion_files/read_motion.h"
#include "skinning/retarget/retarget.h"
#include "tests/skinning/plain_legs.h"

using namespace ecorche;

namespace {

constexpr double kSole = -0.82;  // of the plain skeleton, m

Motion walk_of(const Skeleton& skeleton, RetargetReport& report) {
  RetargetOptions options;
  options.sole_height = kSole;
  return retarget(read_motion(std::filesystem::path(ECORCHE_TEST_DIR) / "../data/motions/walk.bvh"),
                  skeleton, options, report);
}

// As a file in single precision gives it back.
Skeleton read_back(Skeleton skeleton) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> rounding(-6e-8, 6e-8);
  for (Joint& joint : skeleton.joints)
    for (int k = 0; k < 3; ++k) joint.X_PJ.translation()[k] *= 1 + rounding(random);
  return skeleton;
}

}  // namespace

TEST(PlantFeet, BodiesThatAreHardlyAlikeWalkAlike) {
  const Skeleton skeleton = skeleton_with_legs(), other = read_back(skeleton);
  RetargetReport report;
  const Motion motion = walk_of(skeleton, report), again = walk_of(other, report);
  std::vector<Transform> X, Y;
  double apart = 0;
  for (std::size_t f = 0; f < motion.frames.size(); ++f) {
    forward_kinematics(skeleton, motion.frames[f], X);
    forward_kinematics(other, again.frames[f], Y);
    for (std::size_t j = 0; j < X.size(); ++j)
      apart = std::max(apart, (X[j].translation() - Y[j].translation()).norm());
  }
  EXPECT_LT(apart, 1e-5);
}

TEST(PlantFeet, AWalkGivesUpNoStance) {
  RetargetReport report;
  walk_of(skeleton_with_legs(), report);
  EXPECT_GE(report.contacts.size(), 20u);
  for (const std::string& line : report.warnings)
    EXPECT_EQ(line.find("not planted"), std::string::npos) << line;
}

// A heel that leaves turns the foot about its ball.
TEST(PlantFeet, ABallStaysDownWhileItsHeelLeaves) {
  constexpr double kLanding = 0.06;  // s
  const Skeleton skeleton = skeleton_with_legs();
  RetargetReport report;
  const Motion motion = walk_of(skeleton, report);
  const int edge = int(kLanding * motion.fps) + 1;
  std::vector<Transform> X;
  double high = 0;
  for (const Contact& contact : report.contacts) {
    if (contact.heel) continue;
    const FootShape foot = foot_shape(skeleton, contact.side, kSole);
    for (int f = contact.begin + edge; f < contact.end - edge; ++f) {
      forward_kinematics(skeleton, motion.frames[std::size_t(f)], X);
      const FootPoints at = foot_points(skeleton, foot, X);
      high = std::max(high, std::min(at.ball.y(), at.tip.y()));
    }
  }
  EXPECT_LT(high, 1.5e-3);
}
