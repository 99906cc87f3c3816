// Laws of limbs that are kept apart: they come out apart, both give way alike, trunk and head stay,
// nothing leaps, and what does not meet is left alone; feet are as far apart as the file has them.
#include "skinning/constraints/self_collision.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "skinning/constraints/motion_limits.h"
#include "skinning/motion_files/read_motion.h"
#include "skinning/retarget/retarget.h"
#include "tests/skinning/plain_skeleton.h"

using namespace ecorche;
namespace fs = std::filesystem;

namespace {
const fs::path kCaptures = fs::path(ECORCHE_SHARED_DIR) / "testdata" / "motion";

// A skin of rings: tubes of 50 mm about the bones of arms and legs, a head of 90 mm and a trunk 280
// mm by 200 mm.
Points ringed_skin(const Skeleton& skeleton, double thigh = 0.05) {
  const std::vector<Vec3> rest = rest_positions(skeleton);
  const auto at = [&](const std::string& name) { return rest[find_joint(skeleton, name)]; };
  std::vector<Vec3> points;
  const auto tube = [&](const Vec3& from, const Vec3& to, double a, double b) {
    const Vec3 along = (to - from).normalized(), u = along.cross(Vec3::UnitZ()).normalized(),
               v = along.cross(u);
    for (double s = 0; s <= (to - from).norm(); s += 0.01)
      for (int k = 0; k < 24; ++k)
        points.push_back(from + s * along + a * std::cos(k * std::numbers::pi / 12) * u +
                         b * std::sin(k * std::numbers::pi / 12) * v);
  };
  for (const std::string s : {"_l", "_r"}) {
    for (const auto& [from, to] : {std::pair{"hip", "knee"},
                                   {"knee", "ankle"},
                                   {"ankle", "mtp3"},
                                   {"shoulder", "elbow"},
                                   {"elbow", "wrist"},
                                   {"wrist", "dip3"}})
      tube(at(from + s), at(to + s), from == std::string("hip") ? thigh : 0.05,
           from == std::string("hip") ? thigh : 0.05);
  }
  tube(at("pelvis"), at("c7") - Vec3(0, 0.04, 0), 0.14, 0.10);
  tube(at("c7"), at("head"), 0.05, 0.05);
  for (int i = 1; i < 12; ++i)
    for (int k = 0; k < 24; ++k) {
      const double low = i * std::numbers::pi / 12, round = k * std::numbers::pi / 12;
      points.push_back(at("head") + Vec3(0, 0.09, 0) +
                       0.09 * Vec3(std::sin(low) * std::cos(round), std::cos(low),
                                   std::sin(low) * std::sin(round)));
    }
  Points skin(points.size(), 3);
  for (size_t i = 0; i < points.size(); ++i) skin.row(i) = points[i];
  return skin;
}

class KeepApart : public testing::Test {
 protected:
  const Skeleton skeleton_ = plain_skeleton();
  const CollisionProxies rounds_ = measure_proxies(skeleton_, ringed_skin(skeleton_));
  const SelfCollisionTables tables_ = make_collision_tables(skeleton_, rounds_);

  size_t joint(const std::string& name) const { return std::size_t(find_joint(skeleton_, name)); }

  // Legs that pass by each other, so near that they pass through; `high` is how far thighs swing.
  Motion passing(double in, int frames = 120, double fps = 120) const {
    Motion motion{fps, {}};
    for (int f = 0; f < frames; ++f) {
      Pose pose = rest_pose(skeleton_);
      const double swing = 30 * kDegree * std::cos(2 * std::numbers::pi * f / frames);
      for (const double side : {1.0, -1.0})
        pose.rotations[joint(side > 0 ? "hip_l" : "hip_r")] =
            Quat(Eigen::AngleAxisd(side * swing, Vec3::UnitX()) *
                 Eigen::AngleAxisd(-side * in, Vec3::UnitZ()));
      complete_pose(skeleton_, pose);
      motion.frames.push_back(pose);
    }
    return motion;
  }
  Motion kept(Motion motion, const CollisionProxies* rounds) const {
    MotionLimiter(skeleton_, -0.82, rounds).run({}, {}, {}, motion);
    return motion;
  }
  double deepest(const Motion& motion, CollisionKind kind) const {
    double most = 0;
    std::vector<Transform> X;
    for (const Pose& pose : motion.frames) {
      forward_kinematics(skeleton_, pose, X);
      most = std::max(most, penetration_depths(tables_, X)[int(kind)]);
    }
    return most;
  }
};

}  // namespace

TEST_F(KeepApart, BallsAndRoundsAreAsThickAsTheSkin) {
  for (const std::vector<LimbSphere>& limb : rounds_.limbs) {
    EXPECT_GE(limb.size(), 6u);
    for (const LimbSphere& ball : limb) {
      EXPECT_NEAR(ball.radius, 0.05, 0.012) << skeleton_.joints[ball.joint].name;
      EXPECT_GE(ball.middle + ball.end, 0.59);
    }
  }
  ASSERT_EQ(rounds_.trunk.size(), 6u);
  const TrunkEllipsoid &waist = rounds_.trunk[1], &head = rounds_.trunk.back();
  EXPECT_NEAR(waist.half.x(), 0.14, 0.01);
  EXPECT_NEAR(waist.half.z(), 0.10, 0.01);
  EXPECT_NEAR(head.half.x(), 0.09, 0.012);
}

// Thighs that are wider than muscle makes them give way to each other, by 22 mm each at most; lean
// ones do not.
TEST_F(KeepApart, FatGivesWay) {
  const auto allowed = [&](double thigh) {
    CollisionProxies proxies = measure_proxies(skeleton_, ringed_skin(skeleton_, thigh));
    double least = HUGE_VAL, lean = 0;
    for (const ProxyPair& pair : make_collision_tables(skeleton_, proxies).pairs)
      if (pair.kind == CollisionKind::leg_leg && pair.sphere == 0 && pair.other == 0)
        least = pair.allowed,
        lean = 0.08 * (proxies.limbs[0][0].radius + proxies.limbs[1][0].radius);
    return least - lean;
  };
  EXPECT_NEAR(allowed(0.05), 0, 1e-9);
  const double some = allowed(0.09);
  EXPECT_GT(some, 0.005);
  EXPECT_LT(some, 0.03);
  EXPECT_EQ(rounds_.limbs[0][0].gives, 0);
  const CollisionProxies wide = measure_proxies(skeleton_, ringed_skin(skeleton_, 0.2));
  EXPECT_NEAR(wide.limbs[0][0].gives, 0.022, 1e-9);
}

TEST_F(KeepApart, LegsThatPassThroughEachOtherComeOutApart) {
  const Motion before = kept(passing(14 * kDegree), nullptr),
               after = kept(passing(14 * kDegree), &rounds_);
  EXPECT_GT(deepest(before, CollisionKind::leg_leg), 0.03);
  EXPECT_LT(deepest(after, CollisionKind::leg_leg), 0.004);
}

TEST_F(KeepApart, BothLegsGiveWayAlikeAndTheTrunkStays) {
  // In the middle of the way both legs hang side by side: one is the other's mirror image.
  Motion still{120, std::vector<Pose>(30, passing(14 * kDegree, 4).frames[1])};
  const Motion after = kept(still, &rounds_);
  std::vector<Transform> X;
  forward_kinematics(skeleton_, after.frames[15], X);
  for (const std::string name : {"knee", "ankle"}) {
    const Vec3 left = X[joint(name + "_l")].translation(),
               right = X[joint(name + "_r")].translation();
    EXPECT_LT((Vec3(-left.x(), left.y(), left.z()) - right).norm(), 1e-4) << name;
  }
  for (const std::string name : {"pelvis", "l3", "thorax", "head", "shoulder_l", "elbow_r"})
    EXPECT_EQ(after.frames[15].rotations[joint(name)].coeffs(),
              kept(still, nullptr).frames[15].rotations[joint(name)].coeffs())
        << name;
}

TEST_F(KeepApart, WhatDoesNotMeetIsLeftAlone) {
  const Motion apart = passing(-5 * kDegree);
  const Motion a = kept(apart, nullptr), b = kept(apart, &rounds_);
  for (size_t f = 0; f < a.frames.size(); ++f)
    for (size_t j = 0; j < skeleton_.joints.size(); ++j)
      ASSERT_EQ(a.frames[f].rotations[j].coeffs(), b.frames[f].rotations[j].coeffs());
}

TEST_F(KeepApart, NothingLeaps) {
  const Motion before = kept(passing(14 * kDegree), nullptr),
               after = kept(passing(14 * kDegree), &rounds_);
  const auto roughest = [&](const Motion& motion) {
    double most = 0;
    std::vector<Vec3> path;
    std::vector<Transform> X;
    for (const Pose& pose : motion.frames)
      forward_kinematics(skeleton_, pose, X), path.push_back(X[joint("knee_l")].translation());
    for (size_t f = 1; f + 1 < path.size(); ++f)
      most = std::max(most, (path[f - 1] - 2 * path[f] + path[f + 1]).norm());
    return most;
  };
  EXPECT_LT(roughest(after), roughest(before) + 1e-3);
}

TEST_F(KeepApart, AHandComesOutOfTheHead) {
  Motion motion{60, {}};
  std::vector<Transform> X;
  for (int f = 0; f < 60; ++f) {
    Pose pose = rest_pose(skeleton_);
    // The elbow up to the side, the forearm from there to the head's middle, nearer and nearer.
    const std::vector<Vec3> rest = rest_positions(skeleton_);
    const Vec3 shoulder = rest[joint("shoulder_l")], elbow = rest[joint("elbow_l")],
               wrist = rest[joint("wrist_l")];
    const Vec3 head = rest[joint("head")] + Vec3(0.14 - 0.001 * f, 0.09, 0);
    const Quat up = Quat::FromTwoVectors(elbow - shoulder, Vec3(1, 0.6, 0.3));
    const Vec3 bent = shoulder + up * (elbow - shoulder);
    pose.rotations[joint("shoulder_l")] = up;
    pose.rotations[joint("elbow_l")] =
        Quat::FromTwoVectors(wrist - elbow, up.inverse() * (head - bent));
    motion.frames.push_back(pose);
  }
  ASSERT_GT(deepest(kept(motion, nullptr), CollisionKind::arm_head), 0.02);
  EXPECT_LT(deepest(kept(motion, &rounds_), CollisionKind::arm_head),
            0.5 * deepest(kept(motion, nullptr), CollisionKind::arm_head));
}

// A walker of the capture data base whose knees passed through each other on our skeleton.
TEST_F(KeepApart, AWalkersKneesPassBesideEachOther) {
  const fs::path file = kCaptures / "cmu_daz43/02_01.bvh";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is absent";
  RetargetOptions options;
  RetargetReport report;
  const Motion before = retarget(read_motion(file), skeleton_, options, report);
  options.proxies = rounds_;
  const Motion after = retarget(read_motion(file), skeleton_, options, report);
  EXPECT_LT(deepest(after, CollisionKind::leg_leg),
            std::max(0.008, 0.3 * deepest(before, CollisionKind::leg_leg)));
  EXPECT_LT(report.slide_p95, 0.5e-3);
}
