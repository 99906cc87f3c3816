// Laws of retargeting: our own files come back, size does not matter, two conversions of one
// capture agree, rigs are taken over.
#include "skinning/retarget/retarget.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <set>

#include "anatomy/errors.h"
#include "anatomy/joint_angles.h"
#include "skinning/constraints/leg_ik.h"
#include "skinning/motion_files/bvh_read.h"
#include "skinning/motion_files/bvh_write.h"
#include "skinning/motion_files/read_motion.h"
#include "skinning/retarget/handedness.h"
#include "skinning/retarget/joint_map_file.h"
#include "skinning/retarget/joint_mapping.h"
#include "skinning/retarget/joint_names.h"
#include "tests/skinning/plain_skeleton.h"

using namespace ecorche;
namespace fs = std::filesystem;

namespace {
const fs::path kCaptures = fs::path(ECORCHE_SHARED_DIR) / "testdata" / "motion";

// A smooth random movement of all joints about standing.
Motion wiggle(const Skeleton& skeleton, int frames, double size) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<Vec3> axis(skeleton.joints.size());
  std::vector<double> phase(skeleton.joints.size());
  for (size_t j = 0; j < axis.size(); ++j)
    axis[j] = Vec3(normal(random), normal(random), normal(random)).normalized(),
    phase[j] = normal(random);
  Motion motion{.fps = 60, .frames = {}};
  for (int f = 0; f < frames; ++f) {
    Pose pose = rest_pose(skeleton);
    pose.root += Vec3(0.02 * f, 0.05 * std::sin(0.1 * f), 0.01 * f);
    for (size_t j = 0; j < axis.size(); ++j)
      pose.rotations[j] = Quat(Eigen::AngleAxisd(size * std::sin(0.05 * f + phase[j]), axis[j]));
    motion.frames.push_back(pose);
  }
  return motion;
}

RetargetOptions as_is() {
  RetargetOptions options;
  options.plant_feet = options.ballistic_flights = false;
  return options;
}

double largest_angle(const Motion& a, const Motion& b) {
  double largest = 0;
  for (size_t f = 0; f < a.frames.size(); ++f)
    for (size_t j = 0; j < a.frames[f].rotations.size(); ++j)
      largest =
          std::max(largest, a.frames[f].rotations[j].angularDistance(b.frames[f].rotations[j]));
  return largest;
}

void scale_file(BvhMotion& motion, double factor) {
  for (BvhJoint& joint : motion.joints) {
    joint.offset *= factor;
    for (Vec3& site : joint.end_sites) site *= factor;
    for (size_t k = 0; k < joint.channels.size(); ++k)
      if (joint.channels[k] < BvhChannel::x_rotation)
        for (int f = 0; f < motion.frames; ++f)
          motion.samples[f * motion.channels + joint.first_channel + k] *= factor;
  }
}

BvhMotion capture(const char* file) { return read_bvh(kCaptures / file); }

}  // namespace

TEST(Retarget, OurOwnFileComesBack) {
  const Skeleton skeleton = plain_skeleton();
  const Motion motion = wiggle(skeleton, 40, 0.4);
  RetargetReport report;
  const Motion again = retarget(clip_from_bvh(to_bvh(skeleton, motion)), skeleton, as_is(), report);
  EXPECT_TRUE(report.same_rest);
  ASSERT_EQ(again.frames.size(), motion.frames.size());
  EXPECT_LT(largest_angle(motion, again), 1e-6);
  for (size_t f = 0; f < motion.frames.size(); ++f)
    EXPECT_LT((motion.frames[f].root - again.frames[f].root).norm(), 1e-6);
}

TEST(Retarget, OurOwnFileInOtherUnitsAndAxesComesBack) {
  const Skeleton skeleton = plain_skeleton();
  const Motion motion = wiggle(skeleton, 40, 0.4);
  BvhMotion file = to_bvh(skeleton, motion);
  scale_file(file, 39.37);
  RetargetReport report;
  const Motion again = retarget(clip_from_bvh(file), skeleton, as_is(), report);
  EXPECT_EQ(report.unit, "inch");
  EXPECT_LT(largest_angle(motion, again), 1e-6);
}

// Who crawls all the time looks like one who stands along another axis.
TEST(Retarget, OurOwnFileOfACrawlComesBack) {
  const Skeleton skeleton = plain_skeleton();
  Motion motion = wiggle(skeleton, 40, 0.1);
  for (Pose& pose : motion.frames) {
    pose.rotations[0] = Quat(Eigen::AngleAxisd(85 * kDegree, Vec3::UnitX()));
    pose.root.y() += 1;
  }
  RetargetReport report;
  const Motion again = retarget(clip_from_bvh(to_bvh(skeleton, motion)), skeleton, as_is(), report);
  EXPECT_EQ(report.up, 'y');
  EXPECT_LT(largest_angle(motion, again), 1e-6);
}

TEST(Retarget, TheSizeOfTheSourceDoesNotMatter) {
  if (!fs::exists(kCaptures)) GTEST_SKIP() << kCaptures << " is absent";
  const Skeleton skeleton = plain_skeleton();
  RetargetReport report;
  BvhMotion file = capture("cmu_daz43/13_13.bvh");
  const Motion motion = retarget(clip_from_bvh(file), skeleton, {}, report);
  for (const double factor : {0.01, 10.0, 1.7}) {
    BvhMotion other = file;
    scale_file(other, factor);
    const Motion again = retarget(clip_from_bvh(other), skeleton, {}, report);
    EXPECT_LT(largest_angle(motion, again), 1e-6);
    for (size_t f = 0; f < motion.frames.size(); ++f)
      EXPECT_LT((motion.frames[f].root - again.frames[f].root).norm(), 1e-6);
  }
}

// One take, two conversions: 31 joints in CMU units, legs splayed and limbs straight at rest; 43
// joints in centimetres, whose rest pose has elbows bent by 17 and knees by 8 deg with the same
// angles on top. So upper limbs agree, and bends differ by that much throughout.
TEST(Retarget, TwoConversionsOfOneTakeAgree) {
  if (!fs::exists(kCaptures)) GTEST_SKIP() << kCaptures << " is absent";
  const Skeleton skeleton = plain_skeleton();
  RetargetReport a, b;
  const Motion first =
      retarget(clip_from_bvh(capture("cmu_cgspeed31/02_01_walk.bvh")), skeleton, as_is(), a);
  const Motion second =
      retarget(clip_from_bvh(capture("cmu_daz43/02_01.bvh")), skeleton, as_is(), b);
  EXPECT_EQ(a.unit, "CMU unit");
  EXPECT_EQ(b.unit, "cm");
  std::vector<Transform> X, Y;
  for (const auto& [upper, middle, lower, bend] :
       {std::tuple{"hip", "knee", "ankle", 7.7}, std::tuple{"shoulder", "elbow", "wrist", 17.2}})
    for (const std::string side : {"_l", "_r"}) {
      SCOPED_TRACE(upper + side);
      const int i = find_joint(skeleton, upper + side), j = find_joint(skeleton, middle + side),
                k = find_joint(skeleton, lower + side);
      double direction = 0, mean = 0, square = 0;
      int count = 0;
      for (int f = 10; f < 330; f += 5, ++count) {
        // The two lost different numbers of frames at their start; they end alike.
        forward_kinematics(skeleton, first.frames[first.frames.size() - 340 + f], X);
        forward_kinematics(skeleton, second.frames[second.frames.size() - 340 + f], Y);
        auto angle = [](const Vec3& u, const Vec3& v) {
          return std::atan2(u.cross(v).norm(), u.dot(v)) / kDegree;
        };
        auto bone = [](const std::vector<Transform>& Z, int from, int to) {
          return Vec3(Z[to].translation() - Z[from].translation());
        };
        direction += angle(bone(X, i, j), bone(Y, i, j));
        const double off =
            angle(bone(Y, i, j), bone(Y, j, k)) - angle(bone(X, i, j), bone(X, j, k));
        mean += off, square += off * off;
      }
      mean /= count;
      EXPECT_LT(direction / count, 10);
      EXPECT_NEAR(mean, bend, 3);
      EXPECT_LT(std::sqrt(square / count - mean * mean), 3);
    }
}

TEST(Retarget, EveryCaptureKeepsKneesAndElbowsBendingTheRightWay) {
  if (!fs::exists(kCaptures)) GTEST_SKIP() << kCaptures << " is absent";
  const Skeleton skeleton = plain_skeleton();
  for (const char* file :
       {"cmu_cgspeed31/02_01_walk.bvh", "cmu_cgspeed31/131_03.bvh", "cmu_daz43/13_13.bvh",
        "animated_drawings/rokoko_jesse_dance.bvh", "animated_drawings/fair1_jumping.bvh",
        "animated_drawings/fair1_dab.bvh", "bvhtoolbox/walk01.bvh", "bvhtoolbox/test_freebvh.bvh",
        "bvhtoolbox/test_mocapbank.bvh", "pybvh_edge_cases/bvh_test3.bvh"}) {
    SCOPED_TRACE(file);
    RetargetReport report;
    const Motion motion = retarget(clip_from_bvh(capture(file)), skeleton, {}, report);
    for (const Pose& pose : motion.frames) {
      ASSERT_TRUE(pose.root.allFinite());
      for (const Quat& q : pose.rotations) ASSERT_NEAR(q.norm(), 1, 1e-9);
    }
    for (const LimitBreak& broken : report.limit_breaks)
      if (broken.joint.starts_with("knee") || broken.joint.starts_with("elbow")) {
        EXPECT_LT(broken.worst, 15 * kDegree) << broken.joint << " in frame " << broken.worst_frame;
      }
  }
}

TEST(Retarget, ToesTurnedOutTurnTheShinAndKeepTheFootsDirection) {
  const Skeleton skeleton = plain_skeleton();
  const FootShape foot = foot_shape(skeleton, Side::left, guess_sole_height(skeleton));
  const Vec3 shin = skeleton.joints[foot.ankle].X_PJ.translation().normalized();
  Pose pose = rest_pose(skeleton);
  pose.rotations[foot.knee] = Eigen::AngleAxisd(0.8, skeleton.joints[foot.knee].axes.col(0));
  pose.rotations[foot.ankle] = Eigen::AngleAxisd(0.1, skeleton.joints[foot.ankle].axes.col(0));
  pose.rotations[foot.subtalar] = Eigen::AngleAxisd(0.12, shin);
  const auto frames = [&] {
    std::vector<Transform> X_WJ;
    forward_kinematics(skeleton, pose, X_WJ);
    return X_WJ;
  };
  const std::vector<Transform> before = frames();
  turn_shin_with_foot(skeleton, foot, pose);
  const std::vector<Transform> after = frames();
  EXPECT_LT((before[foot.subtalar].linear() - after[foot.subtalar].linear()).norm(), 1e-12);
  EXPECT_LT((before[foot.subtalar].translation() - after[foot.subtalar].translation()).norm(),
            2e-3);
  EXPECT_LT((before[foot.ankle].translation() - after[foot.ankle].translation()).norm(), 1e-12);
  const Quat& subtalar = pose.rotations[foot.subtalar];
  EXPECT_LT(std::abs(subtalar.vec().dot(shin)), 0.2 * std::sin(0.06))
      << "what was a turn about the shin is still in the foot";
  const Joint& knee = skeleton.joints[foot.knee];
  const Vec3 turned = joint_angles(knee, pose.rotations[foot.knee]);
  EXPECT_GE(turned[2], knee.min[2] - 1e-9);
  EXPECT_LE(turned[2], knee.max[2] + 1e-9);
}

// A file that begins with arms spread for the calibration, which then leap down, wait a frame and
// settle.
TEST(Retarget, AMarkerPoseIsLeftOutWithTheFramesInWhichArmsSettle) {
  const Skeleton skeleton = plain_skeleton();
  Motion motion = wiggle(skeleton, 60, 0.02);
  const std::vector<double> arms = {60, 20, 8, 8, 4, 0.3, 0};  // deg
  for (size_t f = 0; f < arms.size(); ++f)
    for (const char* name : {"shoulder_l", "shoulder_r"}) {
      const double side = name[9] == 'l' ? 1 : -1;
      Quat& turn = motion.frames[f].rotations[find_joint(skeleton, name)];
      turn = Quat(Eigen::AngleAxisd(side * arms[f] * kDegree, Vec3::UnitZ())) * turn;
    }
  RetargetReport report;
  const Motion back = retarget(clip_from_bvh(to_bvh(skeleton, motion)), skeleton, as_is(), report);
  EXPECT_EQ(report.dropped_frames, 5);
  EXPECT_EQ(back.frames.size(), motion.frames.size() - 5);
  const Motion without{motion.fps, {motion.frames.begin() + 6, motion.frames.end()}};
  retarget(clip_from_bvh(to_bvh(skeleton, without)), skeleton, as_is(), report);
  EXPECT_EQ(report.dropped_frames, 0);
}

TEST(Retarget, JointsOfOtherProgramsAreKnownByName) {
  const std::vector<std::string> ours = {"clavicle_l", "shoulder_l", "elbow_l", "wrist_l", "hip_l",
                                         "knee_l",     "ankle_l",    "toes_l",  "head"};
  // In that order; what follows is a helper.
  const std::vector<std::vector<std::string>> figures = {
      {"Character1_LeftShoulder", "Character1_LeftArm", "Character1_LeftForeArm",
       "Character1_LeftHand", "Character1_LeftUpLeg", "Character1_LeftLeg", "Character1_LeftFoot",
       "Character1_LeftToeBase", "Character1_Head", "Character1_LeftArmRoll"},
      {"J_Bip_L_Shoulder", "J_Bip_L_UpperArm", "J_Bip_L_LowerArm", "J_Bip_L_Hand",
       "J_Bip_L_UpperLeg", "J_Bip_L_LowerLeg", "J_Bip_L_Foot", "J_Bip_L_ToeBase", "J_Bip_C_Head",
       "J_Sec_Hair1_01"},
      {"ValveBiped.Bip01_L_Clavicle", "ValveBiped.Bip01_L_UpperArm", "ValveBiped.Bip01_L_Forearm",
       "ValveBiped.Bip01_L_Hand", "ValveBiped.Bip01_L_Thigh", "ValveBiped.Bip01_L_Calf",
       "ValveBiped.Bip01_L_Foot", "ValveBiped.Bip01_L_Toe0", "ValveBiped.Bip01_Head",
       "ValveBiped.weapon_bone"},
      {"CC_Base_L_Clavicle", "CC_Base_L_Upperarm", "CC_Base_L_Forearm", "CC_Base_L_Hand",
       "CC_Base_L_Thigh", "CC_Base_L_Calf", "CC_Base_L_Foot", "CC_Base_L_ToeBase", "CC_Base_Head",
       "CC_Base_L_KneeShareBone"},
      {"lCollar", "lShldrBend", "lForearmBend", "lHand", "lThighBend", "lShin", "lFoot", "lToe",
       "head", "lThighTwist"},
      {"Skeleton:LShoulder", "Skeleton:LUArm", "Skeleton:LFArm", "Skeleton:LHand",
       "Skeleton:LThigh", "Skeleton:LShin", "Skeleton:LFoot", "Skeleton:LToe", "Skeleton:Head",
       "Skeleton:LHandIK"},
      {"left_shoulder_1_joint", "left_arm_joint", "left_forearm_joint", "left_hand_joint",
       "left_upLeg_joint", "left_leg_joint", "left_foot_joint", "left_toes_joint", "head_joint",
       "root_joint"},
      {"shoulder.l", "arm_stretch.l", "forearm_stretch.l", "hand.l", "thigh_stretch.l",
       "leg_stretch.l", "foot.l", "toes_01.l", "head.x", "arm_twist.l"},
      {"Scapula_L", "Shoulder_L", "Elbow_L", "Wrist_L", "Hip_L", "Knee_L", "Ankle_L", "Toes_L",
       "Head_M", "HipPart1_L"}};
  const std::map<std::string, std::set<std::string>> also = {
      {"clavicle_l", {"shoulder?_l", "scapula_l"}},
      {"shoulder_l", {"shoulder?_l"}},
      {"hip_l", {"hip?_l"}},
      {"ankle_l", {"foot?_l"}}};
  for (const std::vector<std::string>& names : figures) {
    const std::vector<NamedPart> parts = named_parts(names);
    for (size_t j = 0; j < ours.size(); ++j) {
      const std::string part = parts[j].part + side_suffix(parts[j].side);
      const auto other = also.find(ours[j]);
      EXPECT_TRUE(part == ours[j] || (other != also.end() && other->second.contains(part)))
          << names[j] << " is '" << part << "'";
    }
    EXPECT_EQ(parts.back().part, "") << names.back();
  }
}

TEST(Retarget, FingersOfOtherProgramsAreKnownByName) {
  for (const auto& [name, part] :
       std::map<std::string, std::string>{{"L Finger0", "cmc1"},
                                          {"L Finger02", "ip1"},
                                          {"L Finger1", "mcp2"},
                                          {"L Finger42", "dip5"},
                                          {"LeftFinger1Metacarpal", "cmc1"},
                                          {"LeftFinger2Proximal", "mcp2"},
                                          {"LeftFinger5Distal", "dip5"},
                                          {"leftThumbProximal", "mcp1"},
                                          {"leftLittleIntermediate", "pip5"},
                                          {"finger2-1.L", "mcp2"},
                                          {"index_metacarpal_l", ""},
                                          {"LeftHandIndex3", "dip2"}})
    EXPECT_EQ(named_part(name).part, part) << name;
}

TEST(Retarget, AFootBeyondAnAnkleIsItsToes) {
  const Skeleton skeleton = plain_skeleton();
  BvhMotion file = to_bvh(skeleton, wiggle(skeleton, 2, 0.1));
  for (BvhJoint& joint : file.joints) {
    if (joint.name == "mtp3_l") joint.name = "L_Foot";
    if (joint.name == "mtp3_r") joint.name = "R_Foot";
    if (joint.name.starts_with("mtp") || joint.name.starts_with("toe"))
      joint.name = "x" + joint.name;
    if (joint.name.ends_with("_l") || joint.name.ends_with("_r")) joint.name += "_jnt";
    if (joint.name.starts_with("subtalar")) joint.name = "rear_" + joint.name;
  }
  const JointMapping mapping = map_joints(clip_from_bvh(file), skeleton, {});
  EXPECT_EQ(file.joints[size_t(mapping.rotation_joint.at("toes_l"))].name, "L_Foot");
  EXPECT_EQ(file.joints[size_t(mapping.rotation_joint.at("ankle_l"))].name, "ankle_l_jnt");
}

TEST(Retarget, AFileWithLeftHandedAxesComesBack) {
  const Skeleton skeleton = plain_skeleton();
  const Motion motion = wiggle(skeleton, 20, 0.1);
  const MotionClip file = clip_from_bvh(to_bvh(skeleton, motion));
  RetargetReport report;
  const Motion out = retarget(mirrored(file), skeleton, as_is(), report);
  EXPECT_LT(largest_angle(motion, out), 1e-6);
  ASSERT_FALSE(report.warnings.empty());
  EXPECT_NE(report.warnings[0].find("left-handed"), std::string::npos) << report.warnings[0];
}

TEST(Retarget, WhatIsMissingIsListed) {
  BvhMotion file = to_bvh(plain_skeleton(), wiggle(plain_skeleton(), 2, 0.1));
  for (size_t j = 0; j < file.joints.size(); ++j) file.joints[j].name = fmt::format("joint{}", j);
  file.joints[3].name = "head";
  RetargetReport report;
  try {
    retarget(clip_from_bvh(file), plain_skeleton(), {}, report);
    FAIL();
  } catch (const UnfitError& e) {
    EXPECT_NE(std::string(e.what()).find("knee_l"), std::string::npos) << e.what();
  }
}

TEST(Retarget, AJointMapGivesForeignNamesTheirMeaning) {
  if (!fs::exists(kCaptures)) GTEST_SKIP() << kCaptures << " is absent";
  const Skeleton skeleton = plain_skeleton();
  BvhMotion file = capture("cmu_daz43/02_03.bvh");
  RetargetReport report;
  const Motion motion = retarget(clip_from_bvh(file), skeleton, as_is(), report);
  std::string map = "# foreign = ours\n";
  std::map<std::string, std::string> foreign = {
      {"lShin", "Knie links"}, {"rForeArm", "Unterarm.rechts"}, {"head", "Kopf"}};
  const std::map<std::string, std::string> meaning = {
      {"lShin", "knee_l"}, {"rForeArm", "elbow_r"}, {"head", "head"}};
  for (BvhJoint& joint : file.joints)
    if (foreign.count(joint.name))
      map += foreign[joint.name] + " = " + meaning.at(joint.name) + "  # yes\n",
          joint.name = foreign[joint.name];
  const fs::path path = fs::temp_directory_path() / "ecorche_joint_map.txt";
  std::ofstream(path) << map;
  EXPECT_THROW(retarget(clip_from_bvh(file), skeleton, as_is(), report), UnfitError);
  RetargetOptions options = as_is();
  options.joint_map = read_joint_map(path);
  EXPECT_LT(largest_angle(motion, retarget(clip_from_bvh(file), skeleton, options, report)), 1e-9);
  std::ofstream(path) << "no equals sign\n";
  EXPECT_THROW(read_joint_map(path), InputError);
  fs::remove(path);
}

TEST(Retarget, FeetArePlantedOnATreadmillsBelt) {
  const Skeleton skeleton = plain_skeleton();
  RetargetOptions options;
  options.plant_feet = true;
  options.ballistic_flights = false;
  RetargetReport report;
  const Motion floor =
      retarget(read_motion(fs::path(ECORCHE_TEST_DIR) / "../data/motions/walk.bvh"), skeleton,
               options, report);
  const std::size_t contacts = report.contacts.size();
  ASSERT_GT(contacts, 8u);
  Motion treadmill = floor;
  const Vec3 belt(0.2, 0, -1.4);
  for (std::size_t f = 0; f < treadmill.frames.size(); ++f)
    treadmill.frames[f].root += double(f) / treadmill.fps * belt;
  Motion planted = treadmill;
  report = {};
  constrain_own_motion("treadmill", skeleton, options, planted, report);
  EXPECT_EQ(report.contacts.size(), contacts);
  EXPECT_LT(report.slide_p95, 3e-3);
  ASSERT_FALSE(report.warnings.empty());
  EXPECT_NE(report.warnings.back().find("treadmill"), std::string::npos);
  // it walked well before: little is changed, and it does not leave its place
  EXPECT_LT(largest_angle(planted, treadmill), 0.35);
  for (std::size_t f = 0; f < planted.frames.size(); ++f)
    EXPECT_LT((planted.frames[f].root - treadmill.frames[f].root).norm(), 0.03) << f;
}
