// What `ecorche check` is made of: poses from a table, a tape round a limb, targets that are met or
// not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>

#include "anatomy/errors.h"
#include "anatomy/joint_angles.h"
#include "morph/fit/fit_quality.h"
#include "skinning/checks/anatomy_check.h"
#include "skinning/checks/bodies_check.h"
#include "skinning/checks/bulges.h"
#include "skinning/checks/check_targets.h"

using namespace ecorche;

namespace {

namespace fs = std::filesystem;

Skeleton two_arms() {
  Skeleton skeleton;
  for (const char* name : {"trunk", "elbow_l", "elbow_r", "jaw"}) {
    Joint joint;
    joint.name = name;
    joint.parent = skeleton.joints.empty() ? -1 : 0;
    joint.min = Vec3(-0.2, -0.1, -1);
    joint.max = Vec3(2.5, 0.1, 1.2);
    joint.zero = Vec3(0.3, 0, 0.1);
    if (joint.name == "elbow_r") joint.axes.col(0) *= -1;  // a mirrored side
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

std::vector<LimitPose> poses_of(const std::string& text,
                                UnknownJoints unknown = UnknownJoints::refuse) {
  const fs::path file =
      fs::temp_directory_path() / ("ecorche_poses_" + std::to_string(::getpid()) + ".csv");
  std::ofstream(file, std::ios::binary) << text;
  std::vector<LimitPose> poses;
  try {
    poses = read_limit_poses(file, two_arms(), unknown);
  } catch (...) {
    fs::remove(file);
    throw;
  }
  fs::remove(file);
  return poses;
}

// A tube of `sides` sides along y, bulging in and out by `wave`.
TriMesh tube(const Vec3& at, double radius, double wave, int sides = 240) {
  TriMesh mesh;
  mesh.V.resize(2 * sides, 3);
  mesh.F.resize(2 * sides, 3);
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides, r = radius * (1 - wave * (i % 2));
    mesh.V.row(i) = at + Vec3(r * std::cos(angle), -0.5, r * std::sin(angle));
    mesh.V.row(sides + i) = at + Vec3(r * std::cos(angle), 0.5, r * std::sin(angle));
    const int n = (i + 1) % sides;
    mesh.F.row(2 * i) = Eigen::RowVector3i(i, sides + i, n);
    mesh.F.row(2 * i + 1) = Eigen::RowVector3i(n, sides + i, sides + n);
  }
  return mesh;
}

}  // namespace

TEST(LimitPoses, SharesReachTheLimits) {
  for (const Joint& joint : two_arms().joints) {
    EXPECT_NEAR(joint_angles(joint, limit_rotation(joint, Vec3(1, 0, 0)))[0], 2.5, 1e-9)
        << joint.name;
    EXPECT_NEAR(joint_angles(joint, limit_rotation(joint, Vec3(-1, 0, 0)))[0], -0.2, 1e-9)
        << joint.name;
    EXPECT_NEAR(joint_angles(joint, limit_rotation(joint, Vec3(0.5, 0, 0)))[0], 1.4, 1e-9)
        << joint.name;
    EXPECT_LT(limit_rotation(joint, Vec3::Zero()).angularDistance(Quat::Identity()), 1e-9)
        << joint.name;
  }
}

TEST(LimitPoses, NamesMeanJointsAndRowsOfOnePoseAdd) {
  const auto poses = poses_of(
      "pose,joint,flexion,abduction,rotation\nbent,elbow,1,0,0\nopen,jaw,0.5,0,0\nbent,jaw,1,0,"
      "0\nright,elbow_r,1,0,0\nnone,tail,1,0,0\n",
      UnknownJoints::pass_over);
  ASSERT_EQ(poses.size(), 3u);
  EXPECT_EQ(poses[0].name, "bent");
  const auto turned = [&](std::size_t pose, std::size_t joint) {
    return poses[pose].pose.rotations[joint].angularDistance(Quat::Identity()) > 1e-3;
  };
  EXPECT_TRUE(turned(0, 1) && turned(0, 2) && turned(0, 3));
  EXPECT_TRUE(!turned(1, 1) && !turned(1, 2) && turned(1, 3));
  EXPECT_TRUE(!turned(2, 1) && turned(2, 2) && !turned(2, 3));
}

TEST(LimitPoses, ComplaintsNameTheRow) {
  EXPECT_THROW(poses_of("pose,joint,flexion,abduction,rotation\nbent,elbow,1.5,0,0\n"), InputError);
  EXPECT_THROW(poses_of("pose,joint,flexion,abduction,rotation\n,elbow,1,0,0\n"), InputError);
  EXPECT_THROW(poses_of("pose,joint,flexion\nbent,elbow,1\n"), InputError);
  try {
    poses_of("pose,joint,flexion,abduction,rotation\nbent,elbwo_l,1,0,0\n");
    ADD_FAILURE() << "a joint that is none was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean elbow_l"), std::string::npos)
        << error.what();
  }
}

TEST(TapeGirth, LiesOverHollowsRoundTheNearestPiece) {
  const double circle = 2 * std::numbers::pi * 0.05;
  EXPECT_NEAR(tape_girth(tube({0, 0, 0}, 0.05, 0), {0, 0.1, 0}, Vec3::UnitY()), circle, 2e-5);
  EXPECT_NEAR(tape_girth(tube({0, 0, 0}, 0.05, 0.3), {0, 0.1, 0}, Vec3::UnitY()), circle, 1e-4);
  TriMesh two = tube({0, 0, 0}, 0.05, 0);
  const TriMesh other = tube({0.3, 0, 0}, 0.1, 0);
  const int points = int(two.V.rows()), faces = two.F.rows();
  two.V.conservativeResize(points + other.V.rows(), 3);
  two.V.bottomRows(other.V.rows()) = other.V;
  two.F.conservativeResize(faces + other.F.rows(), 3);
  two.F.bottomRows(other.F.rows()) = (other.F.array() + points).matrix();
  EXPECT_NEAR(tape_girth(two, {0.02, 0, 0}, Vec3::UnitY()), circle, 2e-5);
  EXPECT_NEAR(tape_girth(two, {0.25, 0, 0}, Vec3::UnitY()), 2 * circle, 4e-5);
  EXPECT_EQ(tape_girth(two, {0, 3, 0}, Vec3::UnitY()), 0);
}

TEST(CheckTargets, AreMetOrNot) {
  AnatomyCheck check;
  check.bone_points = check.muscle_points = 10000;
  check.filled_share = 0.97;
  check.shown = 0;
  for (const Target& target : check_targets(check)) EXPECT_TRUE(target.met) << target.what;
  const std::size_t at_rest = check_targets(check).size();  // what was not measured is not listed
  check.poses.resize(1);
  const std::size_t posed = check_targets(check).size();
  check.swept = true;
  EXPECT_EQ(posed, at_rest + 10);
  EXPECT_EQ(check_targets(check).size(), posed + 1);
  check.muscle_points_outside = 6;
  check.overlap_share = check.bone_share = check.bone_overlap.share = 0.03;
  check.filled_share = std::nan("");
  check.loose_ends = check.bone_points_outside = 1;
  check.posed_outside_share = 0.01;
  check.posed_overlap_worst = check.posed_bone_share_worst = 0.06;
  check.posed_loose_ends = check.posed_needles = check.posed_daylight = check.posed_buried = 0.1;
  check.posed_stretch_max = 3.1;
  check.drift_max = 0.01;
  check.jump_max = 0.002;
  check.pierced_share = 0.1;
  check.shown_by_one = 30e-4;
  check.poses[0].bone_points_outside = 1;
  for (const Target& target : check_targets(check)) EXPECT_FALSE(target.met) << target.what;
}

// What `check` asks at rest, `fit` asks, too: one that ends 0 is not condemned afterwards.
TEST(CheckTargets, AreThoseOfAFitAtRest) {
  const auto all_met = [](const AnatomyCheck& check) {
    return std::ranges::all_of(check_targets(check), &Target::met);
  };
  const auto agree = [&](double outside, double overlap, double in_bone, double pierced,
                         double filled, int loose, int torn, int bones, double shown = 0) {
    AnatomyCheck check;
    check.bone_points = check.muscle_points = 100000;
    check.compared = true;
    FittingReport fit;
    check.shown = fit.fill.shown = check.shown_by_one = fit.fill.shown_by_one = shown;
    check.muscle_points_outside = fit.fill.points_outside = int(100000 * outside);
    fit.fill.points = 100000;
    check.overlap_share = fit.fill.overlap_share = overlap;
    check.bone_share = fit.fill.bone_share = in_bone;
    check.pierced_share = fit.fill.pierced_share = pierced;
    check.filled_share = fit.fill.filled_share = filled;
    check.loose_ends = fit.fill.loose_ends = loose;
    check.torn = torn;
    fit.fill.torn.assign(std::size_t(torn), "soleus_l");
    check.bone_points_outside = fit.fit.bones_outside = bones;
    EXPECT_EQ(missed_targets(fit).empty(), all_met(check));
    return all_met(check);
  };
  EXPECT_TRUE(agree(0.0005, 0.02, 0.01, 0.05, 0.95, 0, 0, 0));
  EXPECT_FALSE(agree(0.0006, 0.02, 0.01, 0.05, 0.95, 0, 0, 0));
  EXPECT_FALSE(agree(0.0005, 0.021, 0.01, 0.05, 0.95, 0, 0, 0));
  EXPECT_FALSE(agree(0.0005, 0.02, 0.011, 0.05, 0.95, 0, 0, 0));
  EXPECT_FALSE(agree(0.0005, 0.02, 0.01, 0.051, 0.95, 0, 0, 0));
  EXPECT_FALSE(agree(0.0005, 0.02, 0.01, 0.05, 0.949, 0, 0, 0));
  EXPECT_FALSE(agree(0.0005, 0.02, 0.01, 0.05, 0.95, 1, 0, 0));
  EXPECT_FALSE(agree(0.0005, 0.02, 0.01, 0.05, 0.95, 0, 1, 0));
  EXPECT_FALSE(agree(0.0005, 0.02, 0.01, 0.05, 0.95, 0, 0, 1));
  EXPECT_TRUE(agree(0.0005, 0.02, 0.01, 0.05, 0.95, 0, 0, 0, 19.9e-4));
  EXPECT_FALSE(agree(0.0005, 0.02, 0.01, 0.05, 0.95, 0, 0, 0, 20.1e-4));
}

TEST(CheckBodies, AreTwentyWithNamesOfTheirOwn) {
  std::set<std::string> names;
  int men = 0;
  for (const BodySpec& body : checked_bodies())
    names.insert(body.name), men += body.sex == Sex::male;
  EXPECT_EQ(names.size(), 20u);
  EXPECT_GE(men, 8);
  EXPECT_LE(men, 12);
}

TEST(CheckBodies, ARowABodyAndACellAColumn) {
  std::vector<BodyCheck> checks(2);
  checks[0].name = "one";
  checks[1].name = "two";
  checks[1].check.poses.resize(1);
  std::istringstream csv(bodies_csv(checks));
  std::string line;
  std::vector<long> commas;
  while (std::getline(csv, line)) commas.push_back(std::count(line.begin(), line.end(), ','));
  ASSERT_EQ(commas.size(), 3u);
  EXPECT_EQ(commas[0], commas[1]);
  EXPECT_EQ(commas[0], commas[2]);
  EXPECT_TRUE(bodies_table(checks).find("two") != std::string::npos);
  EXPECT_FALSE(is_met(checks[0]));  // nothing filled
}
