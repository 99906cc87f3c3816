// Laws of planted feet over a whole walk.
#include "skinning/constraints/plant_feet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <string>

#include "anatomy/joint_angles.h"
#include "skinning/constraints/foot_contacts.h"
#include "skinning/constraints/leg_ik.h"
#include "skinning/constraints/leg_room.h"
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

constexpr double kFps = 120;

// Feet at their places of the rest pose but for `moved`, m, by side, under a pelvis that sinks by
// `sinks`, m.
Pose standing_pose(const Skeleton& skeleton, double sinks, const std::array<Vec3, 2>& moved) {
  Pose pose;
  pose.rotations.assign(skeleton.joints.size(), Quat::Identity());
  pose.root = rest_positions(skeleton)[0] - Vec3(0, kSole + sinks, 0);
  std::vector<Transform> X;
  const std::vector<Vec3> rest = rest_positions(skeleton);
  for (int side = 0; side < 2; ++side) {
    const FootShape foot = foot_shape(skeleton, side == 0 ? Side::left : Side::right, kSole);
    forward_kinematics(skeleton, pose, X);
    reach_with_leg(skeleton, foot, rest[std::size_t(foot.ankle)] - Vec3(0, kSole, 0) + moved[side],
                   Mat3::Identity(), pose, X);
  }
  return pose;
}

std::vector<Contact> standing(int begin, int end, std::initializer_list<Side> sides) {
  std::vector<Contact> out;
  for (const Side side : sides)
    for (const bool heel : {true, false}) out.push_back({side, heel, begin, end});
  return out;
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

// Who squats deeper than hips and ankles bend has a higher pelvis, and heels that rise.
TEST(PlantFeet, LegsFoldNoFurtherThanTheirJointsBend) {
  Skeleton skeleton = skeleton_with_legs();
  for (const char* hip : {"hip_l", "hip_r"})
    skeleton.joints[std::size_t(find_joint(skeleton, hip))].max[0] = 30 * kDegree;
  Motion motion{kFps, {}};
  for (int f = 0; f <= 240; ++f)
    motion.frames.push_back(standing_pose(skeleton, 0.23 * (1 - std::cos(2 * M_PI * f / 240)),
                                          {Vec3::Zero(), Vec3::Zero()}));
  const Motion given = motion;
  plant_feet(skeleton, kSole, standing(0, 241, {Side::left, Side::right}), 1, {}, nullptr, motion);
  std::vector<Transform> X, Y;
  double asked = 0;
  for (std::size_t f = 0; f < motion.frames.size(); ++f) {
    forward_kinematics(skeleton, motion.frames[f], X);
    forward_kinematics(skeleton, given.frames[f], Y);
    for (const Side side : {Side::left, Side::right}) {
      const FootShape foot = foot_shape(skeleton, side, kSole);
      const auto bent = [&](int j, const Motion& of) {
        return joint_angles(skeleton.joints[std::size_t(j)],
                            of.frames[f].rotations[std::size_t(j)])[0] /
               kDegree;
      };
      EXPECT_LT(bent(foot.hip, motion), 38) << f;
      EXPECT_LT(bent(foot.ankle, motion), std::max(36.0, bent(foot.ankle, given) - 20)) << f;
      asked = std::max(asked, bent(foot.hip, given));
      const Vec3 ball = foot_points(skeleton, foot, X).ball,
                 was = foot_points(skeleton, foot, Y).ball;
      EXPECT_LT((ball - was).norm(), 2e-3) << f;
    }
    if (f < 2) continue;
    const double turn =
        (motion.frames[f].root - 2 * motion.frames[f - 1].root + motion.frames[f - 2].root).norm() *
        kFps * kFps;
    EXPECT_LT(turn, 15) << f;  // m/s^2; of the squat itself: 3
  }
  EXPECT_GT(asked, 40);
}

// A free leg that is pulled stretches less and less, and stays where it is straight by itself.
TEST(LegRoom, AFreeLegEasesOut) {
  double last = 0;
  for (double far = 0.9; far < 1.1; far += 1e-3) {
    const double near = eased_reach(far, 0.9, 1, kStretches);
    EXPECT_GE(near, last);
    EXPECT_LE(near, kStraight);
    if (far < kStretches) EXPECT_EQ(near, far);
    last = near;
  }
  EXPECT_EQ(eased_reach(0.9995, 0.9995, 1, kStretches), 0.9995);  // as it was by itself
  EXPECT_EQ(eased_reach(0.995, 0.9, 1, 0.996), 0.995);
}
