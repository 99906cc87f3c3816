// Laws of tables of joint angles: a motion comes back from its own table.
#include "skinning/motion_files/joint_angle_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/skinning/plain_skeleton.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

// All joints turn about a skew axis, also those whose models hold an angle fixed; it walks off.
Motion skew_motion(const Skeleton& skeleton, int frames) {
  Motion out{.fps = 120, .frames = {}};
  for (int f = 0; f < frames; ++f) {
    Pose pose = rest_pose(skeleton);
    pose.root += Vec3(0.01 * f, 0.02 * std::sin(0.3 * f), -0.03 * f);
    for (std::size_t j = 0; j < pose.rotations.size(); ++j)
      pose.rotations[j] = Quat(
          Eigen::AngleAxisd(0.3 * std::sin(0.2 * f + double(j)), Vec3(1, 0.4, -0.3).normalized()));
    complete_pose(skeleton, pose);
    out.frames.push_back(std::move(pose));
  }
  return out;
}

TEST(JointAngleTable, AMotionComesBackFromItsTable) {
  const Skeleton skeleton = plain_skeleton();
  const Motion motion = skew_motion(skeleton, 25);
  const fs::path file =
      fs::path(::testing::TempDir()) / ("angles_" + std::to_string(::getpid()) + ".mot");
  write_motion_table(file, joint_angle_table(skeleton, motion));
  std::ifstream in(file);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const CoordinateTable table = parse_coordinates(text, "a.mot");
  fs::remove(file);
  ASSERT_TRUE(has_own_angles(table));
  std::vector<std::string> warnings;
  const Motion again = motion_of_angles(table, skeleton, {}, warnings);
  EXPECT_TRUE(warnings.empty());
  EXPECT_NEAR(again.fps, motion.fps, 1e-6);
  ASSERT_EQ(again.frames.size(), motion.frames.size());
  std::vector<Transform> X, Y;
  for (std::size_t f = 0; f < motion.frames.size(); ++f) {
    forward_kinematics(skeleton, motion.frames[f], X);
    forward_kinematics(skeleton, again.frames[f], Y);
    for (std::size_t j = 0; j < X.size(); ++j)
      EXPECT_LT((X[j].translation() - Y[j].translation()).norm(), 2e-6)
          << skeleton.joints[j].name << " in frame " << f;
  }
}

TEST(JointAngleTable, WhatIsMissingRestsAtItsZeroAndStrangersAreTold) {
  const Skeleton skeleton = plain_skeleton();
  CoordinateTable table{.name = "a.mot",
                        .columns = {"knee_l_flexion", "tail_flexion"},
                        .times = {0},
                        .rows = {{90, 1}},
                        .degrees = true,
                        .warnings = {}};
  EXPECT_FALSE(has_own_angles(table));
  std::vector<std::string> warnings;
  const Motion motion = motion_of_angles(table, skeleton, 24.0, warnings);
  EXPECT_EQ(motion.fps, 24);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("tail_flexion"), std::string::npos);
  std::vector<Transform> X;
  forward_kinematics(skeleton, motion.frames[0], X);
  const auto at = [&](const char* name) {
    return Vec3(X[std::size_t(find_joint(skeleton, name))].translation());
  };
  const Vec3 thigh = at("knee_l") - at("hip_l"), shin = at("ankle_l") - at("knee_l"),
             other = at("ankle_r") - at("knee_r");
  EXPECT_NEAR(thigh.normalized().dot(shin.normalized()), 0, 0.1);
  EXPECT_GT((at("knee_r") - at("hip_r")).normalized().dot(other.normalized()), 0.98);
}

}  // namespace
}  // namespace ecorche
