// The body package's own rigs: a file whose rest pose is ours is taken over rotation for rotation.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "anatomy/base_mesh/body_rig.h"
#include "skinning/motion_files/bvh_read.h"
#include "skinning/retarget/retarget.h"
#include "tests/body_fixture.h"
#include "tests/skinning/plain_skeleton.h"

using namespace ecorche;

namespace {

using RigMotion = BodyFixture;

// A rig as a file of joints with world-aligned rest frames, every joint turning about its own axis,
// gently or by up to 50 deg.
BvhMotion swing(const Rig& rig, bool z_up, double metres_per_unit) {
  BvhMotion file;
  file.name = rig.name + ".bvh";
  file.fps = 30;
  file.frames = 40;
  auto axes = [&](const Vec3& v) {
    return Vec3((z_up ? Vec3(v.x(), -v.z(), v.y()) : v) / metres_per_unit);
  };
  std::vector<std::vector<int>> children(rig.names.size() + 1);
  for (size_t j = 0; j < rig.names.size(); ++j) children[rig.parents[j] + 1].push_back(int(j));
  std::vector<int> stack(children[0].rbegin(), children[0].rend()), place(rig.names.size());
  while (!stack.empty()) {
    const int j = stack.back();
    stack.pop_back();
    stack.insert(stack.end(), children[j + 1].rbegin(), children[j + 1].rend());
    BvhJoint joint;
    joint.name = rig.names[j];
    joint.parent = rig.parents[j] < 0 ? -1 : place[rig.parents[j]];
    joint.offset =
        axes(rig.heads[j] - (rig.parents[j] < 0 ? Vec3(Vec3::Zero()) : rig.heads[rig.parents[j]]));
    if (children[j + 1].empty()) joint.end_sites.push_back(axes(rig.tails[j] - rig.heads[j]));
    if (rig.parents[j] < 0)
      joint.channels = {BvhChannel::x_position, BvhChannel::y_position, BvhChannel::z_position};
    joint.channels.insert(joint.channels.end(),
                          {BvhChannel::z_rotation, BvhChannel::x_rotation, BvhChannel::y_rotation});
    joint.first_channel = file.channels;
    file.channels += joint.channels.size();
    place[j] = file.joints.size();
    file.joints.push_back(joint);
  }
  std::mt19937 random(11);
  std::uniform_real_distribution<double> angle(-12, 12), phase(0, 6);
  std::vector<std::array<double, 4>> move(file.joints.size());
  for (auto& m : move) m = {angle(random), angle(random), angle(random), phase(random)};
  for (int f = 0; f < file.frames; ++f)
    for (size_t j = 0; j < file.joints.size(); ++j) {
      if (file.joints[j].parent < 0)
        for (int k = 0; k < 3; ++k) file.samples.push_back(file.joints[j].offset[k] + 0.01 * f);
      for (int k = 0; k < 3; ++k)
        file.samples.push_back(move[j][k] * std::sin(0.2 * f + move[j][3]));
    }
  return file;
}

void expect_taken_over(const Rig& rig, bool z_up, double unit,
                       const std::map<std::string, std::string>& pairs) {
  SCOPED_TRACE(rig.name);
  const Skeleton skeleton = plain_skeleton();
  const BvhMotion file = swing(rig, z_up, unit);
  RetargetOptions options;
  options.plant_feet = options.ballistic_flights = false;
  RetargetReport report;
  const Motion motion = retarget(clip_from_bvh(file), skeleton, options, report);
  EXPECT_TRUE(report.same_rest);
  EXPECT_TRUE(report.matching_rig);
  EXPECT_EQ(report.up, z_up ? 'z' : 'y');
  Mat3 W = Mat3::Identity();
  if (z_up) W << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const MotionClip clip = clip_from_bvh(file);
  std::vector<Transform> theirs, ours;
  for (int f = 0; f < file.frames; ++f) {
    clip_kinematics(clip, f, theirs);
    forward_kinematics(skeleton, motion.frames[f], ours);
    for (const auto& [file_joint, our_joint] : pairs) {
      int j = -1;
      for (size_t k = 0; k < file.joints.size(); ++k)
        if (file.joints[k].name == file_joint) j = int(k);
      ASSERT_GE(j, 0) << file_joint;
      ASSERT_LT(
          (W * theirs[j].linear() * W.transpose() - ours[find_joint(skeleton, our_joint)].linear())
              .norm(),
          1e-6)
          << file_joint << " -> " << our_joint << " frame " << f;
    }
  }
}

// The same pairs on both sides, with the rig's way of writing them: "%" stands for the side.
std::map<std::string, std::string> paired(const std::map<std::string, std::string>& one,
                                          const char* left, const char* right) {
  std::map<std::string, std::string> out;
  for (const auto& [file_joint, our_joint] : one)
    for (const bool is_left : {true, false}) {
      std::string name = file_joint;
      if (const size_t at = name.find('%'); at != std::string::npos)
        name.replace(at, 1, is_left ? left : right);
      out[name] = file_joint.find('%') == std::string::npos ? our_joint
                                                            : our_joint + (is_left ? "_l" : "_r");
    }
  return out;
}

}  // namespace

TEST_F(RigMotion, DefaultRigIsTakenOver) {
  const Rig rig = read_rig(package(), "default", package().points);
  const auto pairs = paired({{"root", "pelvis"},
                             {"spine01", "thorax"},
                             {"head", "head"},
                             {"jaw", "jaw"},
                             {"upperarm02.%", "shoulder"},
                             {"lowerarm01.%", "elbow"},
                             {"lowerarm02.%", "forearm"},
                             {"wrist.%", "wrist"},
                             {"finger1-1.%", "cmc1"},
                             {"finger2-1.%", "mcp2"},
                             {"finger3-2.%", "pip3"},
                             {"finger5-3.%", "dip5"},
                             {"upperleg02.%", "hip"},
                             {"lowerleg02.%", "knee"},
                             {"foot.%", "subtalar"},
                             {"toe1-1.%", "mtp1"},
                             {"toe1-2.%", "toe_ip1"},
                             {"toe4-1.%", "mtp4"},
                             {"toe5-3.%", "toe_dip5"}},
                            "L", "R");
  expect_taken_over(rig, false, 1, pairs);
  expect_taken_over(rig, true, 0.1, pairs);
}

TEST_F(RigMotion, CmuRigIsTakenOver) {
  expect_taken_over(read_rig(package(), "cmu_mb", package().points), false, 0.01,
                    paired({{"Hips", "pelvis"},
                            {"Spine1", "thorax"},
                            {"Head", "head"},
                            {"%Shoulder", "clavicle"},
                            {"%Arm", "shoulder"},
                            {"%ForeArm", "forearm"},
                            {"%UpLeg", "hip"},
                            {"%Leg", "knee"},
                            {"%Foot", "subtalar"},
                            {"%ToeBase", "mtp2"}},
                           "Left", "Right"));
}

TEST_F(RigMotion, MixamoRigIsTakenOver) {
  expect_taken_over(read_rig(package(), "mixamo", package().points), true, 1,
                    paired({{"mixamorig:Hips", "pelvis"},
                            {"mixamorig:Spine2", "thorax"},
                            {"mixamorig:Head", "head"},
                            {"mixamorig:%Shoulder", "clavicle"},
                            {"mixamorig:%Arm", "shoulder"},
                            {"mixamorig:%ForeArm", "forearm"},
                            {"mixamorig:%Hand", "wrist"},
                            {"mixamorig:%HandIndex2", "pip2"},
                            {"mixamorig:%HandThumb1", "cmc1"},
                            {"mixamorig:%UpLeg", "hip"},
                            {"mixamorig:%Leg", "knee"},
                            {"mixamorig:%Foot", "subtalar"},
                            {"mixamorig:%ToeBase", "mtp3"}},
                           "Left", "Right"));
}

TEST_F(RigMotion, GameEngineRigIsTakenOver) {
  expect_taken_over(read_rig(package(), "game_engine", package().points), true, 0.01,
                    paired({{"pelvis", "pelvis"},
                            {"spine_03", "thorax"},
                            {"head", "head"},
                            {"clavicle_%", "clavicle"},
                            {"upperarm_%", "shoulder"},
                            {"lowerarm_%", "forearm"},
                            {"hand_%", "wrist"},
                            {"pinky_03_%", "dip5"},
                            {"thigh_%", "hip"},
                            {"calf_%", "knee"},
                            {"foot_%", "subtalar"},
                            {"ball_%", "mtp1"}},
                           "l", "r"));
}

namespace {

std::size_t joint_named(const BvhMotion& file, const std::string& name) {
  for (std::size_t k = 0; k < file.joints.size(); ++k)
    if (file.joints[k].name == name) return k;
  throw std::invalid_argument(name);
}

// The frames of a rig's file, in cm, at rest (its first frame) and in another one.
class RigFrames {
 public:
  RigFrames(const BvhMotion& file, const Skeleton& skeleton)
      : file_(file),
        skeleton_(skeleton),
        clip_(clip_from_bvh(file)),
        rest_(rest_positions(skeleton)) {
    clip_kinematics(clip_, 0, still_);
  }
  void go_to(int frame) { clip_kinematics(clip_, frame, now_); }
  // Where one of our joints is that moves with a joint of the rig, m.
  Vec3 place(const std::string& rig_joint, const std::string& ours) const {
    const std::size_t j = joint_named(file_, rig_joint);
    return 0.01 * (now_[j] * (still_[j].inverse() * (100 * rest_[find_joint(skeleton_, ours)])));
  }

 private:
  const BvhMotion& file_;
  const Skeleton& skeleton_;
  const MotionClip clip_;
  const std::vector<Vec3> rest_;  // of our joints, m
  std::vector<Transform> still_, now_;
};

// The rest pose, and then frames of a swing.
BvhMotion rest_and_swing(const Rig& rig) {
  BvhMotion file = swing(rig, false, 0.01);
  for (int c = 0; c < file.channels; ++c) file.samples[c] = c < 3 ? file.joints[0].offset[c] : 0;
  return file;
}

}  // namespace

TEST_F(RigMotion, AnOwnRigAtRestIsTheBodyAtRest) {
  const Skeleton skeleton = plain_skeleton();
  for (const char* name : {"default", "cmu_mb", "mixamo", "game_engine"}) {
    SCOPED_TRACE(name);
    RetargetReport report;
    const Motion motion =
        retarget(clip_from_bvh(rest_and_swing(read_rig(package(), name, package().points))),
                 skeleton, {}, report);
    const Pose rest = rest_pose(skeleton);
    EXPECT_TRUE(report.matching_rig);
    EXPECT_LT((motion.frames[0].root - rest.root).norm(), 1e-6)
        << "m; the rig's hips are up to 5 cm beside the body's";
    for (std::size_t j = 0; j < rest.rotations.size(); ++j)
      EXPECT_LT(motion.frames[0].rotations[j].angularDistance(rest.rotations[j]), 1e-6)
          << skeleton.joints[j].name;
  }
}

// What the rig does to the body's places, reckoned from the file alone: the mean of all of them
// comes to where the rig has it.
TEST_F(RigMotion, AnOwnRigTakesTheWholeBodyAlong) {
  const Skeleton skeleton = plain_skeleton();
  const Rig rig = read_rig(package(), "default", package().points);
  const BvhMotion file = rest_and_swing(rig);
  RetargetReport report;
  const Motion motion = retarget(clip_from_bvh(file), skeleton, {}, report);
  RigFrames theirs(file, skeleton);
  std::vector<Transform> ours;
  double worst = 0;
  for (int f = 0; f < file.frames; ++f) {
    theirs.go_to(f);
    forward_kinematics(skeleton, motion.frames[f], ours);
    Vec3 mean = Vec3::Zero();
    const std::vector<std::pair<std::string, std::string>> places{{"upperleg02.", "hip_"},
                                                                  {"lowerleg02.", "knee_"},
                                                                  {"lowerarm01.", "elbow_"},
                                                                  {"upperarm02.", "shoulder_"}};
    for (const auto& [bone, own] : places)
      for (const bool left : {true, false}) {
        const std::string here = own + (left ? "l" : "r");
        mean += (theirs.place(bone + (left ? "L" : "R"), here) -
                 ours[find_joint(skeleton, here)].translation()) /
                8;
      }
    worst = std::max(worst, mean.norm());
  }
  EXPECT_LT(worst, 0.006) << "m; with hips laid on hips it is 0.02 and more";
}

// The rig's spine lies in the middle of the body and bends between the ribs, too: ours comes to the
// same place all the same, and by small turns.
TEST_F(RigMotion, ThoraxAndHeadComeToWhereAnOwnRigHasThem) {
  const Skeleton skeleton = plain_skeleton();
  BvhMotion file = rest_and_swing(read_rig(package(), "default", package().points));
  std::fill(file.samples.begin() + file.channels, file.samples.end(), 0.0);
  for (int f = 0; f < file.frames; ++f)
    for (const char* bone : {"spine05", "spine04", "spine03", "spine02", "spine01", "neck01",
                             "neck02", "neck03"})  // Z-X-Y
      file.samples[f * file.channels + file.joints[joint_named(file, bone)].first_channel + 1] =
          8.0 * f / file.frames;
  RetargetReport report;
  const Motion motion = retarget(clip_from_bvh(file), skeleton, {}, report);
  RigFrames theirs(file, skeleton);
  theirs.go_to(file.frames - 1);
  std::vector<Transform> ours;
  forward_kinematics(skeleton, motion.frames.back(), ours);
  const auto at = [&](const char* own) {
    return Vec3(ours[find_joint(skeleton, own)].translation());
  };
  EXPECT_LT(
      ((at("c7") - at("l5")) - (theirs.place("spine01", "c7") - theirs.place("root", "l5"))).norm(),
      0.008)
      << "m";
  EXPECT_LT(
      ((at("head") - at("c7")) - (theirs.place("head", "head") - theirs.place("spine01", "c7")))
          .norm(),
      0.010)
      << "m";
  const Pose &pose = motion.frames.back(), before = motion.frames[motion.frames.size() - 2];
  for (const char* name :
       {"l5", "l4", "l3", "l2", "l1", "t12", "t11", "c7", "c6", "c5", "c4", "c3", "c2", "c1"}) {
    const std::size_t j = find_joint(skeleton, name);
    EXPECT_LT(pose.rotations[j].angularDistance(Quat::Identity()), 0.3) << name;
    EXPECT_LT(pose.rotations[j].angularDistance(before.rotations[j]), 0.02) << name;
  }
}

namespace {

// The default rig in which these joints of the left side turn about Z, at the last frame by
// `degrees`.
BvhMotion turned(const Rig& rig, const std::vector<std::string>& joints, double degrees) {
  BvhMotion file = rest_and_swing(rig);
  std::fill(file.samples.begin() + file.channels, file.samples.end(), 0.0);
  for (int f = 0; f < file.frames; ++f)
    for (const BvhJoint& joint : file.joints)
      if (std::find(joints.begin(), joints.end(), joint.name) != joints.end())
        file.samples[std::size_t(f * file.channels + joint.first_channel)] =
            degrees * f / (file.frames - 1);
  return file;
}

}  // namespace

// Two joints of the rig's collar stand for clavicle and shoulder blade, and neither lies where ours
// do.
TEST_F(RigMotion, ACollarTakesTheShoulderToWhereAnOwnRigHasIt) {
  const Skeleton skeleton = plain_skeleton();
  const BvhMotion file =
      turned(read_rig(package(), "default", package().points), {"clavicle.L", "shoulder01.L"}, 15);
  RetargetReport report;
  const Motion motion = retarget(clip_from_bvh(file), skeleton, {}, report);
  RigFrames theirs(file, skeleton);
  theirs.go_to(file.frames - 1);
  std::vector<Transform> ours;
  forward_kinematics(skeleton, motion.frames.back(), ours);
  const auto reach = [&](const std::vector<Transform>& X) {
    return Vec3(X[find_joint(skeleton, "shoulder_l")].translation() -
                X[find_joint(skeleton, "clavicle_l")].translation());
  };
  const Vec3 wanted =
      theirs.place("shoulder01.L", "shoulder_l") - theirs.place("spine01", "clavicle_l");
  EXPECT_LT((reach(ours) - wanted).norm(), 0.010) << "m";
}

TEST_F(RigMotion, AShoulderBladeTurnsWithTheArmOfAnOwnRig) {
  const Skeleton skeleton = plain_skeleton();
  const BvhMotion file =
      turned(read_rig(package(), "default", package().points), {"upperarm01.L"}, 60);
  RetargetReport report;
  const Motion motion = retarget(clip_from_bvh(file), skeleton, {}, report);
  std::vector<Transform> ours;
  forward_kinematics(skeleton, motion.frames.back(), ours);
  const auto turn = [&](const char* joint) {
    return Quat(Mat3(ours[find_joint(skeleton, "thorax")].linear().transpose() *
                     ours[find_joint(skeleton, joint)].linear()))
               .angularDistance(Quat::Identity()) /
           kDegree;
  };
  EXPECT_GT(turn("scapula_l"), 10) << "degrees, of 60 of the arm";
  EXPECT_LT(turn("scapula_l"), 20) << "degrees";
  EXPECT_LT(turn("scapula_r"), 0.1) << "degrees";
}

// A body and its rig measure limbs between different points: 1.0 to 1.5 % in people.
TEST_F(RigMotion, AnOwnRigNeedNotMeasureLimbsAsTheBodyDoes) {
  Rig rig = read_rig(package(), "default", package().points);
  for (auto* places : {&rig.heads, &rig.tails})
    for (Vec3& place : *places) place *= 0.984;
  RetargetReport report;
  retarget(clip_from_bvh(rest_and_swing(rig)), plain_skeleton(), {}, report);
  EXPECT_TRUE(report.matching_rig);
}

TEST_F(RigMotion, PosesOfAnOwnRigComeInAnyOrder) {
  const Skeleton skeleton = plain_skeleton();
  const BvhMotion file = rest_and_swing(read_rig(package(), "mixamo", package().points));
  BvhMotion back = file;
  const auto row = [&](int f) { return file.samples.begin() + std::ptrdiff_t(f) * file.channels; };
  for (int f = 0; f < file.frames; ++f)
    std::copy(row(f), row(f) + file.channels,
              back.samples.begin() + std::ptrdiff_t(file.frames - 1 - f) * file.channels);
  RetargetReport report;
  const Motion there = retarget(clip_from_bvh(file), skeleton, {}, report),
               here = retarget(clip_from_bvh(back), skeleton, {}, report);
  for (std::size_t f = 0; f < there.frames.size(); ++f) {
    const Pose &a = there.frames[f], &b = here.frames[there.frames.size() - 1 - f];
    EXPECT_EQ(a.root, b.root)
        << "no foot is planted, no flight bent: the file is where its author has put it";
    for (std::size_t j = 0; j < a.rotations.size(); ++j)
      EXPECT_LT(a.rotations[j].angularDistance(b.rotations[j]), 1e-9);
  }
}

TEST_F(RigMotion, ALargerBodysRigIsNotOwn) {
  Rig rig = read_rig(package(), "default", package().points);
  for (auto* places : {&rig.heads, &rig.tails})
    for (Vec3& place : *places) place *= 1.06;
  RetargetReport report;
  retarget(clip_from_bvh(rest_and_swing(rig)), plain_skeleton(), {}, report);
  EXPECT_TRUE(report.same_rest);
  EXPECT_FALSE(report.matching_rig);
}
