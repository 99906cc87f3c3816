#include "skinning/motion/raise_arm.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "plain_skeleton.h"
#include "skinning/motion/limit_poses.h"

using namespace ecorche;

namespace {

Vec3 upper_arm(const Skeleton& skeleton, const Pose& pose, Side side) {
  std::vector<Transform> X;
  forward_kinematics(skeleton, pose, X);
  const auto at = [&](const char* joint) {
    return Vec3(X[find_joint(skeleton, std::string(joint) + side_suffix(side))].translation());
  };
  return (at("elbow") - at("shoulder")).normalized();
}

}  // namespace

TEST(RaiseArm, PointsWhereItIsAskedTo) {
  const Skeleton skeleton = plain_skeleton();
  for (const Side side : {Side::left, Side::right}) {
    const double out = side == Side::right ? -1 : 1;
    ASSERT_TRUE(has_arm(skeleton, side));
    for (const double elevation : {0.0, 0.4, 1.6, 2.9})
      for (const double plane : {-0.8, 0.0, 0.9, 1.57}) {
        Pose pose = rest_pose(skeleton);
        raise_arm(skeleton, side, {elevation, plane, 0.5}, pose);
        const Vec3 wanted(out * std::sin(elevation) * std::cos(plane), -std::cos(elevation),
                          std::sin(elevation) * std::sin(plane));
        EXPECT_NEAR((upper_arm(skeleton, pose, side) - wanted).norm(), 0, 1e-9)
            << elevation << " " << plane;
      }
  }
}

TEST(RaiseArm, TakesSharesOfHalfATurnFromATable) {
  const Skeleton skeleton = plain_skeleton();
  const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                     ("ecorche_arms_" + std::to_string(::getpid()) + ".csv");
  std::ofstream(file) << "pose,joint,flexion,abduction,rotation\nforwards,arm,0.5,0,0\n"
                         "left,arm_l,0,0.5,0\nback,arm,-0.25,0,0\nup,arm,1,1,0\n";
  const std::vector<LimitPose> poses = read_limit_poses(file, skeleton, UnknownJoints::refuse);
  std::filesystem::remove(file);
  ASSERT_EQ(poses.size(), 4u);
  const double half = std::sqrt(0.5);
  const Vec3 rest = upper_arm(skeleton, rest_pose(skeleton), Side::right);
  for (const Side side : {Side::left, Side::right}) {
    const auto off = [&](int pose, const Vec3& wanted) {
      return (upper_arm(skeleton, poses[std::size_t(pose)].pose, side) - wanted).norm();
    };
    EXPECT_LT(off(0, Vec3::UnitZ()), 1e-9);
    EXPECT_LT(off(1, side == Side::left ? Vec3(Vec3::UnitX()) : rest), 1e-9);
    EXPECT_LT(off(2, Vec3(0, -half, -half)), 1e-9);
    EXPECT_LT(off(3, Vec3::UnitY()), 1e-9);
  }
}
