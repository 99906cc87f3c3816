#include "skinning/motion/pose_book.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numbers>

#include "anatomy/errors.h"
#include "anatomy/geometry/self_intersections.h"
#include "anatomy/joint_angles.h"
#include "skinning/motion/pose_table.h"
#include "tests/skinning/arm.h"
#include "tests/skinning/plain_skeleton.h"

namespace ecorche {
namespace {
class PoseBook : public ::testing::Test {
 protected:
  Skeleton skeleton_ = plain_skeleton();
  std::vector<Transform> X_;

  std::size_t joint(const std::string& name) const {
    return std::size_t(find_joint(skeleton_, name));
  }
  Pose pose(const std::string& angles) const { return pose_of_angles(angles, skeleton_, "test"); }
  Vec3 direction(const std::string& angles, const std::string& from, const std::string& to) {
    forward_kinematics(skeleton_, pose(angles), X_);
    return (X_[joint(to)].translation() - X_[joint(from)].translation()).normalized();
  }
};

TEST_F(PoseBook, AnglesAreTheJointsOwn) {
  const Pose bent = pose("elbow 120; knee_l 90");
  EXPECT_NEAR(joint_angles(skeleton_.joints[joint("elbow_l")], bent.rotations[joint("elbow_l")])[0],
              120 * kDegree, 1e-9);
  EXPECT_NEAR(joint_angles(skeleton_.joints[joint("elbow_r")], bent.rotations[joint("elbow_r")])[0],
              120 * kDegree, 1e-9);
  EXPECT_NEAR(joint_angles(skeleton_.joints[joint("knee_l")], bent.rotations[joint("knee_l")])[0],
              90 * kDegree, 1e-9);
  EXPECT_LT(bent.rotations[joint("knee_r")].angularDistance(Quat::Identity()), 1e-12);
  EXPECT_GT(bent.rotations[joint("patella_l")].angularDistance(Quat::Identity()),
            0.5);  // dependent joints follow
}

TEST_F(PoseBook, ArmsPointWhereElevationAndPlaneSay) {
  EXPECT_LT((direction("arm 0 0", "shoulder_l", "elbow_l") - Vec3(0, -1, 0)).norm(), 1e-6);
  EXPECT_LT((direction("arm 90 0", "shoulder_l", "elbow_l") - Vec3(1, 0, 0)).norm(), 1e-6);
  EXPECT_LT((direction("arm 90 0", "shoulder_r", "elbow_r") - Vec3(-1, 0, 0)).norm(), 1e-6);
  EXPECT_LT((direction("arm 90 90", "shoulder_l", "elbow_l") - Vec3(0, 0, 1)).norm(), 1e-6);
  EXPECT_LT((direction("arm 180 40", "shoulder_r", "elbow_r") - Vec3(0, 1, 0)).norm(), 1e-6);
}

TEST_F(PoseBook, BothSidesMirrorEachOther) {
  forward_kinematics(skeleton_,
                     pose("arm 70 40 30; elbow 100; fingers 90 80 70; hip 60 20 10; knee 80"), X_);
  for (const std::string name : {"elbow", "wrist", "dip3", "knee", "ankle"}) {
    const Vec3 l = X_[joint(name + "_l")].translation(), r = X_[joint(name + "_r")].translation();
    EXPECT_LT((l - Vec3(-r.x(), r.y(), r.z())).norm(), 1e-6) << name;
  }
}

TEST_F(PoseBook, TrunkAndNeckAddUpToWhatIsAsked) {
  const Pose bent = pose("trunk 60; neck 30");
  forward_kinematics(skeleton_, bent, X_);
  EXPECT_NEAR(Eigen::AngleAxisd(X_[joint("thorax")].linear()).angle(), 60 * kDegree, 1e-6);
  EXPECT_NEAR(Eigen::AngleAxisd(X_[joint("head")].linear()).angle(), 90 * kDegree, 1e-6);
  EXPECT_GT(X_[joint("head")].translation().z(),
            X_[joint("pelvis")].translation().z() + 0.2);  // forwards
}

TEST_F(PoseBook, WhatCannotBeReadIsNamed) {
  for (const char* bad : {"tail 10", "elbow", "elbow ten", "elbow 1 2 3 4", "elbow nan",
                          "elbow 1e9", "arm 90", "fingers 90", "trunk -"})
    EXPECT_THROW(pose(bad), InputError) << bad;
}

TEST_F(PoseBook, OurOwnBookIsSixtyDifferentPosesWithinReach) {
  const std::vector<NamedPose> book =
      read_pose_book(std::string(ECORCHE_TEST_DIR) + "/../data/poses/poses.csv", skeleton_);
  EXPECT_EQ(book.size(), 60u);
  for (const NamedPose& each : book) {
    EXPECT_FALSE(each.label.empty());
    double turned = 0;
    for (const Quat& q : each.pose.rotations) {
      EXPECT_TRUE(q.coeffs().allFinite()) << each.name;
      turned += q.angularDistance(Quat::Identity());
    }
    EXPECT_GT(turned, 0.1) << each.name;
  }
}

// Either kind of table is read by its columns, for `check` and for pictures alike.
TEST_F(PoseBook, TablesOfSharesAndOfAnglesAreTakenAlike) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("ecorche_table_" + std::to_string(::getpid()));
  const Joint& elbow = skeleton_.joints[joint("elbow_l")];
  const auto both = [&](const std::string& text) {
    std::ofstream(file) << text;
    const std::vector<NamedPose> named = read_pose_table(file, skeleton_);
    const std::vector<LimitPose> checked = read_check_poses(file, skeleton_);
    std::filesystem::remove(file);
    EXPECT_EQ(named.size(), 1u);
    EXPECT_EQ(checked.size(), 1u);
    EXPECT_EQ(named.at(0).name, "bent");
    EXPECT_EQ(checked.at(0).name, "bent");
    const Quat q = named.at(0).pose.rotations[joint("elbow_l")];
    EXPECT_LT(q.angularDistance(checked.at(0).pose.rotations[joint("elbow_l")]), 1e-12);
    return joint_angles(elbow, q)[0];
  };
  const double limit = elbow.max[0];
  EXPECT_NEAR(both("pose,joint,flexion,abduction,rotation\nbent,elbow,1,0,0\n"), limit, 1e-9);
  EXPECT_NEAR(
      both(fmt::format("name,label,view,angles\nbent,b,front,elbow {:.12f}\n", limit / kDegree)),
      limit, 1e-9);
}

TEST(SelfIntersections, AreCountedInTrianglesAndGoneWhenMovedApart) {
  const TriMesh one = test::capsule(Vec3::Zero(), Vec3(0, 1, 0), 0.2, 16);
  EXPECT_EQ(count_self_intersections(one.F, one.V), 0);
  TriMesh two{Points(2 * one.V.rows(), 3), Triangles(2 * one.F.rows(), 3)};
  two.F << one.F, (one.F.array() + int(one.V.rows())).matrix();
  const auto apart = [&](double x) {
    two.V << one.V, (one.V.rowwise() + Eigen::RowVector3d(x, 0.013, 0.007)).matrix();
    return count_self_intersections(two.F, two.V);
  };
  EXPECT_EQ(apart(0.5), 0);
  EXPECT_GT(apart(0.3), 10);
  EXPECT_LT(apart(0.3), int(two.F.rows()) / 2);
}

}  // namespace
}  // namespace ecorche
