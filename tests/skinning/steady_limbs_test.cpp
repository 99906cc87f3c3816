// Laws of limbs that are slowed: a leg that snaps is slowed and its planted foot stays, and a limb
// without fault is returned as it is.
#include "skinning/constraints/steady_limbs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "skinning/constraints/foot_contacts.h"
#include "skinning/constraints/leg_ik.h"
#include "tests/skinning/plain_legs.h"

namespace ecorche {
namespace {

constexpr int kFrames = 80, kSnap = 30, kLift = 50;  // the left foot stands until it lifts

class SteadyLimbs : public testing::Test {
 protected:
  const Skeleton skeleton_ = skeleton_with_legs();
  const double sole_ = guess_sole_height(skeleton_);
  const LimitTables tables_ = make_limit_tables(skeleton_, sole_);
  const std::vector<Contact> contacts_ = {{Side::left, true, 0, kLift},
                                          {Side::left, false, 0, kLift},
                                          {Side::right, true, 0, kFrames},
                                          {Side::right, false, 0, kFrames}};

  // Knees bend a little more and less over standing feet; the left foot then lifts. From kSnap on
  // the left knee points outwards by `outwards`, rad.
  Motion squat(double outwards) const {
    Motion out{60, std::vector<Pose>(kFrames, rest_pose(skeleton_))};
    std::vector<Transform> X;
    for (int f = 0; f < kFrames; ++f) {
      Pose& pose = out.frames[std::size_t(f)];
      pose.root += Vec3(0, -0.15 - 0.05 * std::sin(0.1 * f) - sole_, 0);  // the ground is y = 0
      for (const Side side : {Side::left, Side::right}) {
        const FootShape foot = foot_shape(skeleton_, side, sole_);
        Vec3 ankle = rest_positions(skeleton_)[std::size_t(foot.ankle)] - Vec3(0, sole_, 0);
        if (side == Side::left) {
          const double turn = f < kSnap ? 0 : outwards;
          pose.rotations[std::size_t(foot.hip)] = Quat(Eigen::AngleAxisd(turn, Vec3::UnitY()));
          ankle.y() += 0.05 * (1 - std::cos(0.1 * std::max(0, f - kLift)));
        }
        forward_kinematics(skeleton_, pose, X);
        reach_with_leg(skeleton_, foot, ankle, Mat3::Identity(), pose, X);
      }
      complete_pose(skeleton_, pose);
    }
    return out;
  }

  // Top speed of the left knee, m/s, about the pelvis.
  double knee_speed(const Motion& motion) const {
    double top = 0;
    Vec3 last = Vec3::Zero();
    std::vector<Transform> X;
    for (std::size_t f = 0; f < motion.frames.size(); ++f) {
      forward_kinematics(skeleton_, motion.frames[f], X);
      const Vec3 here =
          X[std::size_t(tables_.limbs[0].joints[1])].translation() - X[0].translation();
      if (f > 0) top = std::max(top, motion.fps * (here - last).norm());
      last = here;
    }
    return top;
  }

  FootPoints left_foot(const Pose& pose) const {
    std::vector<Transform> X;
    forward_kinematics(skeleton_, pose, X);
    return foot_points(skeleton_, tables_.feet[0], X);
  }
};

TEST_F(SteadyLimbs, APlantedFootStaysWhereItsLegIsSlowed) {
  const Motion given = squat(0), snaps = squat(0.6);
  Motion motion = snaps;
  ASSERT_GT(knee_speed(snaps), 4);
  EXPECT_GT(steady_limbs(skeleton_, tables_, given, given, contacts_, motion), 0);
  EXPECT_LT(knee_speed(motion), 0.4 * knee_speed(snaps));
  for (int f = 0; f < kLift; ++f) {
    const FootPoints was = left_foot(snaps.frames[std::size_t(f)]),
                     is = left_foot(motion.frames[std::size_t(f)]);
    EXPECT_LT(std::hypot(is.heel.x() - was.heel.x(), is.heel.z() - was.heel.z()), 6e-3) << f;
    EXPECT_LT((is.ball - was.ball).norm(), 0.5e-3) << f;
  }
  // It comes off its place in time.
  for (int f = kLift; f < kFrames; ++f)
    EXPECT_LT((left_foot(motion.frames[std::size_t(f)]).ball -
               left_foot(motion.frames[std::size_t(f - 1)]).ball)
                      .norm() *
                  motion.fps,
              1.5)
        << f;
}

TEST_F(SteadyLimbs, LimbsWithoutFaultStay) {
  const Motion given = squat(0), snaps = squat(0.6);
  Motion motion = given;
  EXPECT_EQ(steady_limbs(skeleton_, tables_, given, given, contacts_, motion), 0);
  for (std::size_t f = 0; f < motion.frames.size(); ++f)
    for (std::size_t j = 0; j < motion.frames[f].rotations.size(); ++j)
      ASSERT_EQ(motion.frames[f].rotations[j].coeffs(), given.frames[f].rotations[j].coeffs());
  motion = snaps;
  steady_limbs(skeleton_, tables_, given, given, contacts_, motion);
  for (std::size_t f = 0; f < motion.frames.size(); ++f)
    for (std::size_t l = 1; l < tables_.limbs.size(); ++l)
      for (const int j : tables_.limbs[l].joints)
        ASSERT_LT(motion.frames[f].rotations[std::size_t(j)].angularDistance(
                      snaps.frames[f].rotations[std::size_t(j)]),
                  1e-6)
            << f << ' ' << skeleton_.joints[std::size_t(j)].name;
}

}  // namespace
}  // namespace ecorche
