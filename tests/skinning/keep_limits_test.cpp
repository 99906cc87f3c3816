// Laws of limits: every pose comes inside, hands and feet stay where they can, left is right
// mirrored, nothing leaps, and a capture comes out inside with its feet planted.
#include "skinning/constraints/joint_limits.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "anatomy/joint_angles.h"
#include "skinning/constraints/foot_contacts.h"
#include "skinning/constraints/leg_ik.h"
#include "skinning/constraints/motion_limits.h"
#include "skinning/motion_files/bvh_read.h"
#include "skinning/motion_files/read_motion.h"
#include "skinning/retarget/retarget.h"
#include "tests/skinning/plain_legs.h"

using namespace ecorche;
namespace fs = std::filesystem;

namespace {
const fs::path kLimitCaptures = fs::path(ECORCHE_SHARED_DIR) / "testdata" / "motion";
const fs::path kOwn = fs::path(ECORCHE_TEST_DIR) / ".." / "data" / "motions";

class KeepLimits : public testing::Test {
 protected:
  const Skeleton skeleton_ = skeleton_with_legs();
  const LimitTables tables_ = make_limit_tables(skeleton_, guess_sole_height(skeleton_));
  LimitWorkspace scratch_;

  int joint(const std::string& name) const { return find_joint(skeleton_, name); }
  Pose kept(Pose pose) {
    enforce_limits(skeleton_, tables_, {}, {}, {}, pose, scratch_);
    return pose;
  }
  // The kneecap follows the knee; fingers of the plain skeleton go sideways by up to a right angle,
  // where such angles cease to mean anything.
  double worst(const Pose& pose) const {
    double most = 0;
    for (size_t j = 1; j < skeleton_.joints.size(); ++j) {
      const Joint& joint = skeleton_.joints[j];
      const bool counts =
          !joint.name.starts_with("patella") && std::abs(joint.max[1] - 90 * kDegree) > kDegree;
      if (counts) most = std::max(most, limit_excess(joint, pose.rotations[j]));
    }
    return most;
  }
  Pose bent(const std::string& name, const Vec3& angles) const {
    Pose pose = rest_pose(skeleton_);
    pose.rotations[joint(name)] =
        joint_rotation(skeleton_.joints[joint(name)], skeleton_.joints[joint(name)].zero + angles);
    return pose;
  }
};

// q as its mirror image in the plane x = 0.
Quat mirrored(const Quat& q) { return Quat(q.w(), q.x(), -q.y(), -q.z()); }

}  // namespace

TEST_F(KeepLimits, AnyPoseComesInside) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 50; ++round) {
    Pose pose = rest_pose(skeleton_);
    for (Quat& q : pose.rotations)
      q = Quat(1.5, normal(random), normal(random), normal(random)).normalized();
    const Pose inside = kept(pose);
    EXPECT_LT(worst(inside), 1e-4);
    for (const Quat& q : inside.rotations) EXPECT_NEAR(q.norm(), 1, 1e-9);
    EXPECT_EQ(inside.root, pose.root);
  }
}

TEST_F(KeepLimits, APoseWellInsideStays) {
  Pose pose = rest_pose(skeleton_);
  for (const std::string s : {"_l", "_r"})
    for (const auto& [name, angles] : {std::pair{"hip", Vec3(0.5, 0.05, 0)},
                                       {"knee", Vec3(0.7, 0, 0)},
                                       {"ankle", Vec3(-0.2, 0, 0)},
                                       {"elbow", Vec3(0.6, 0, 0)}})
      pose.rotations[joint(name + s)] = bent(name + s, angles).rotations[joint(name + s)];
  ASSERT_LT(worst(pose), 1e-9);
  const Pose inside = kept(pose);
  for (const LimbChain& limb : tables_.limbs) {
    const size_t end = limb.joints[3];
    EXPECT_LT((scratch_.before[end] * limb.point - scratch_.after[end] * limb.point).norm(), 1e-3)
        << skeleton_.joints[end].name;
  }
  for (size_t j = 0; j < pose.rotations.size(); ++j)
    EXPECT_TRUE(skeleton_.joints[j].name.starts_with("patella") ||
                inside.rotations[j].angularDistance(pose.rotations[j]) < 4 * kDegree)
        << skeleton_.joints[j].name;
}

TEST_F(KeepLimits, AFootThatAsksTooMuchOfTheAnkleRisesOnItsBall) {
  Pose pose = rest_pose(skeleton_);
  for (const auto& [name, degrees] :
       {std::pair{"hip_l", 80.0}, {"knee_l", 100.0}, {"ankle_l", 45.0}})
    pose.rotations[joint(name)] = bent(name, Vec3(degrees * kDegree, 0, 0)).rotations[joint(name)];
  ASSERT_GT(worst(pose), 10 * kDegree);
  enforce_limits(skeleton_, tables_, {0.5e-3, kDegree}, {}, {}, pose,
                 scratch_);  // as while it stands
  const size_t foot = joint("subtalar_l");
  const Vec3& ball = tables_.limbs[0].point;
  EXPECT_LT((scratch_.before[foot] * ball - scratch_.after[foot] * ball).norm(), 8e-3);
  const Vec3 pitch =
      (scratch_.after[foot].linear() * scratch_.before[foot].linear().transpose()) * Vec3::UnitZ();
  EXPECT_LT(pitch.y(), -std::sin(5 * kDegree)) << "the toes point down against before";
}

TEST_F(KeepLimits, LeftIsRightMirrored) {
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  Pose pose = rest_pose(skeleton_), mirror = pose;
  for (size_t j = 1; j < skeleton_.joints.size(); ++j) {
    const std::string& name = skeleton_.joints[j].name;
    if (!name.ends_with("_l")) continue;
    const Quat q = Quat(4, normal(random), normal(random), normal(random)).normalized();
    pose.rotations[j] = q;
    mirror.rotations[joint(name.substr(0, name.size() - 2) + "_r")] = mirrored(q);
  }
  const Pose left = kept(pose), right = kept(mirror);
  for (size_t j = 1; j < skeleton_.joints.size(); ++j) {
    const std::string& name = skeleton_.joints[j].name;
    if (!name.ends_with("_l")) continue;
    const Quat other = mirrored(right.rotations[joint(name.substr(0, name.size() - 2) + "_r")]);
    EXPECT_LT(left.rotations[j].angularDistance(other), 1e-3) << name;
  }
}

// A movement that runs into a limit and on for 60 degrees: no other joint moves faster than three
// times as much.
TEST_F(KeepLimits, NothingLeapsWhereAMovementRunsIntoALimit) {
  for (const auto& [name, start] : {std::pair{"ankle_l", Vec3(0.1, 0, 0)},
                                    {"subtalar_l", Vec3(0, 0, 0.2)},
                                    {"wrist_l", Vec3(0, 0.2, 0)},
                                    {"scapula_l", Vec3(0.2, 0, 0)},
                                    {"l3", Vec3(0.1, 0, 0)}}) {
    Pose pose = bent(name, Vec3::Zero());
    pose.rotations[joint("knee_l")] = bent("knee_l", Vec3(0.6, 0, 0)).rotations[joint("knee_l")];
    Pose before;
    for (int step = 0; step <= 240; ++step) {
      Vec3 angles = start.normalized() * step * 0.25 * kDegree;
      pose.rotations[joint(name)] = bent(name, angles).rotations[joint(name)];
      const Pose now = kept(pose);
      for (size_t j = 1; step > 0 && j < now.rotations.size(); ++j)
        ASSERT_LT(now.rotations[j].angularDistance(before.rotations[j]), 0.75 * kDegree)
            << name << " at " << step << ": " << skeleton_.joints[j].name;
      before = now;
    }
  }
}

TEST_F(KeepLimits, MotionsComeOutInsideWithFeetPlanted) {
  std::vector<fs::path> files = {kOwn / "long_jump.bvh", kOwn / "walk.bvh"};
  for (const char* name :
       {"cmu_cgspeed31/02_01_walk.bvh", "cmu_cgspeed31/05_16.bvh", "cmu_daz43/13_13.bvh"})
    if (fs::exists(kLimitCaptures / name)) files.push_back(kLimitCaptures / name);
  for (const fs::path& file : files) {
    SCOPED_TRACE(file);
    RetargetReport report;
    const Motion motion = retarget(read_motion(file), skeleton_, {}, report);
    EXPECT_TRUE(report.limit_breaks.empty()) << report.limit_breaks.front().joint;
    for (const Pose& pose : motion.frames) ASSERT_LT(worst(pose), 1e-4);
    EXPECT_FALSE(report.limit_breaks_before.empty());
    ASSERT_EQ(report.ends_moved.size(), 5u);
    if (file.filename() == "05_16.bvh")
      continue;  // a damaged capture: thighs and feet leap by half a turn
    EXPECT_LT(report.slide_p95, 0.5e-3);
    EXPECT_LT(report.penetration, 1e-3);
    for (const EndMove& end : report.ends_moved) EXPECT_LT(end.most, 0.04) << end.end;
  }
}

// A squat deeper than hip and ankle bend: the pelvis comes up rather than the knees fall in, and
// the feet stay.
TEST_F(KeepLimits, KneesDoNotFallInWhenASquatIsTooDeep) {
  const double sole = guess_sole_height(skeleton_);
  Motion motion{60, std::vector<Pose>(20, rest_pose(skeleton_))};
  std::vector<Contact> contacts;
  std::vector<Transform> X, given;
  for (const Side side : {Side::left, Side::right}) {
    const FootShape foot = foot_shape(skeleton_, side, sole);
    const Vec3 ankle = rest_positions(skeleton_)[foot.ankle] - Vec3(0, sole, 0);
    for (Pose& pose : motion.frames) {
      pose.root = Vec3(0, 0.30, -0.10);
      forward_kinematics(skeleton_, pose, X);
      reach_with_leg(skeleton_, foot, ankle, Mat3::Identity(), pose, X);
    }
    for (const bool heel : {true, false}) contacts.push_back({side, heel, 0, 20, 0});
  }
  forward_kinematics(skeleton_, motion.frames[10], given);
  MotionLimiter(skeleton_, sole, nullptr).run({0.5e-3, kDegree, true}, contacts, {}, motion);
  forward_kinematics(skeleton_, motion.frames[10], X);
  EXPECT_GT(X[0].translation().y(), 0.32);
  EXPECT_LT(worst(motion.frames[10]), 1e-4);
  for (const char* name : {"knee_l", "knee_r"}) {
    const size_t j = joint(name);
    EXPECT_LT(std::abs(X[j].translation().x() - given[j].translation().x()), 0.03) << name;
  }
  for (const char* name : {"subtalar_l", "subtalar_r"}) {
    const size_t j = joint(name);
    EXPECT_LT((X[j].translation() - given[j].translation()).norm(), 0.06) << name;
  }
}

// Where soles touch down they are as fast as the file has them: what holds a foot at its place
// fades in before, and stops nothing.
TEST_F(KeepLimits, FeetTouchDownAsFastAsTheFileHasThem) {
  const double sole = guess_sole_height(skeleton_);
  for (const char* name : {"long_jump.bvh", "walk.bvh"}) {
    const MotionClip file = read_motion(kOwn / name);
    RetargetOptions free;
    free.plant_feet = free.ballistic_flights = false;
    free.clamp_limits = false;
    RetargetReport report, unused;
    const Motion ours = retarget(file, skeleton_, {}, report),
                 theirs = retarget(file, skeleton_, free, unused);
    const auto point = [&](const Motion& motion, const Contact& contact, int f) {
      std::vector<Transform> X;
      forward_kinematics(skeleton_, motion.frames[f], X);
      const FootPoints at = foot_points(skeleton_, foot_shape(skeleton_, contact.side, sole), X);
      return contact.heel ? at.heel : at.ball;
    };
    int touchdowns = 0;
    for (const Contact& contact : report.contacts) {
      const auto stands_already = [&](const Contact& other) {
        return other.side == contact.side && other.begin < contact.begin &&
               contact.begin <= other.end;
      };
      if (contact.begin < 2 ||
          std::any_of(report.contacts.begin(), report.contacts.end(), stands_already))
        continue;
      ++touchdowns;
      const Vec3 step =
          point(ours, contact, contact.begin - 1) - point(ours, contact, contact.begin - 2);
      const Vec3 given =
          point(theirs, contact, contact.begin - 1) - point(theirs, contact, contact.begin - 2);
      EXPECT_LT((step - given).norm() * ours.fps, 0.25 + 0.15 * given.norm() * ours.fps)
          << name << ' ' << contact.begin << (contact.heel ? " heel" : " ball");
    }
    EXPECT_GE(touchdowns, 10) << name;
  }
}

TEST_F(KeepLimits, KneecapsFollowKneesThatPlantingBends) {
  RetargetOptions options;
  options.clamp_limits = false;
  RetargetReport report;
  const Motion motion = retarget(read_motion(kOwn / "walk.bvh"), skeleton_, options, report);
  for (const Pose& pose : motion.frames)
    for (const std::string s : {"_l", "_r"}) {
      const Joint& knee = skeleton_.joints[joint("knee" + s)];
      const Quat& turn = pose.rotations[joint("knee" + s)];
      const double bent = 2 * std::atan2(turn.vec().dot(knee.axes.col(0)), turn.w());
      const Quat wanted(Eigen::AngleAxisd(0.62 * std::remainder(bent, 2 * std::numbers::pi),
                                          Vec3(knee.axes.col(0))));
      ASSERT_LT(pose.rotations[joint("patella" + s)].angularDistance(wanted), 1e-6);
    }
}

// A limited frame depends on the file's frame alone: every second frame of a file gives every
// second pose. Contacts are left out, since they begin and end on frames.
TEST_F(KeepLimits, TheRateOfFramesDoesNotMatter) {
  const BvhMotion file = read_bvh(kOwn / "long_jump.bvh");
  BvhMotion half = file;
  half.fps = file.fps / 2, half.frames = (file.frames + 1) / 2;
  half.samples.clear();
  for (int f = 0; f < file.frames; f += 2)
    half.samples.insert(half.samples.end(), file.samples.begin() + f * file.channels,
                        file.samples.begin() + (f + 1) * file.channels);
  RetargetOptions options;
  options.plant_feet = options.ballistic_flights = false;
  RetargetReport report;
  const Motion all = retarget(clip_from_bvh(file), skeleton_, options, report),
               some = retarget(clip_from_bvh(half), skeleton_, options, report);
  for (size_t f = 0; f < some.frames.size(); ++f)
    for (size_t j = 0; j < skeleton_.joints.size(); ++j)
      ASSERT_LT(some.frames[f].rotations[j].angularDistance(all.frames[2 * f].rotations[j]),
                0.5 * kDegree)
          << f << ' ' << skeleton_.joints[j].name;
}
