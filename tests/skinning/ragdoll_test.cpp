// Bodies that fall and limbs that hang: closed solutions, what is kept, what must not be passed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "anatomy/joint_angles.h"
#include "skinning/motion/center_of_mass.h"
#include "skinning/motion/require_joint.h"
#include "skinning/ragdoll/fall.h"
#include "skinning/ragdoll/limp_motion.h"
#include "tests/skinning/plain_skeleton.h"

namespace ecorche {
namespace {

constexpr double kG = 9.81;

Joint free_joint(const std::string& name, int parent, const Vec3& from_parent) {
  Joint out;
  out.name = name;
  out.parent = parent;
  out.X_PJ.translation() = from_parent;
  return out;
}

// A box about its only joint, with its corners as points.
Ragdoll box(const Vec3& half, double mass) {
  Ragdoll out;
  out.body.skeleton.joints = {free_joint("body", -1, Vec3::Zero())};
  const Vec3 squares = half.cwiseAbs2();
  const Vec3 inertia = mass / 3 * (Vec3::Constant(squares.sum()) - squares);
  out.body.segments = {{"body", 0, mass, Vec3::Zero(), inertia.asDiagonal()}};
  for (const int x : {-1, 1})
    for (const int y : {-1, 1})
      for (const int z : {-1, 1}) out.points.push_back({0, half.cwiseProduct(Vec3(x, y, z))});
  return out;
}

BodyState lying(const Ragdoll& ragdoll, double height) {
  BodyState out;
  out.pose = rest_pose(ragdoll.body.skeleton);
  put_at_height(ragdoll, height, out.pose);
  out.velocity.setZero(ragdoll.body.freedoms());
  return out;
}

FallOptions seconds(double count) {
  FallOptions out;
  out.seconds = count;
  return out;
}

// Of 70 kg on the plain skeleton, its skin a ball of points about each joint of a limb or the
// trunk.
Ragdoll person() {
  const Skeleton skeleton = plain_skeleton();
  const CenterOfMass table(skeleton);
  std::vector<BodySegment> segments;
  double sum = 0;
  for (const CenterOfMass::Segment& each : table.segments()) sum += each.mass;
  for (const CenterOfMass::Segment& each : table.segments()) {
    const double mass = 70 * each.mass / sum, gyration = std::max(0.05, each.centre.norm() / 2);
    segments.push_back({skeleton.joints[std::size_t(each.joint)].name, each.joint, mass,
                        each.centre, mass * gyration * gyration * Mat3::Identity()});
  }
  const std::vector<Vec3> rest = rest_positions(skeleton);
  std::vector<Vec3> places;
  std::vector<JointWeights> weights;
  for (std::size_t j = 0; j < rest.size(); ++j) {
    const std::string& name = skeleton.joints[j].name;
    const bool small = name.find_first_of("12345") != std::string::npos && name[0] != 'l';
    for (int k = 0; k < 40; ++k) {  // spread over a ball by the golden angle
      const double y = 1 - (2 * (k / 2) + 1) / 20.0, r = std::sqrt(1 - y * y),
                   a = 2.399963 * (k / 2);
      const double mirror = (k % 2 ? -1 : 1);
      const Vec3 way(mirror * r * std::cos(a), y, r * std::sin(a));
      places.push_back(rest[j] + (small ? 0.02 : 0.06) * way);
      weights.push_back({Influence{int(j), 1.0}});
    }
  }
  Points skin(Eigen::Index(places.size()), 3);
  for (std::size_t i = 0; i < places.size(); ++i) skin.row(Eigen::Index(i)) = places[i];
  return make_ragdoll(skeleton, segments, skin, weights);
}

Vec3 angular_momentum(const Ragdoll& ragdoll, const BodyState& state, Vec3& momentum) {
  BodyFrames frames;
  body_frames(ragdoll.body, state.pose, frames);
  momentum.setZero();
  Vec3 out = Vec3::Zero();
  for (const BodySegment& segment : ragdoll.body.segments) {
    const std::size_t j = std::size_t(segment.joint);
    const Mat3 R = frames.X_WJ[j].linear();
    const Vec3 w = frames.jacobian[j].topRows<3>() * state.velocity,
               v = frames.jacobian[j].bottomRows<3>() * state.velocity +
                   w.cross(Vec3(R * segment.center));
    momentum += segment.mass * v;
    out += segment.mass * (frames.X_WJ[j] * segment.center).cross(v) +
           R * segment.inertia * R.transpose() * w;
  }
  return out;
}

TEST(Ragdoll, FlightKeepsMomentumAndEnergy) {
  Ragdoll ragdoll = person();
  RagdollState state;
  state.body = lying(ragdoll, 0);
  state.rest = set_frictionless(state.body.pose, ragdoll.body);
  for (Eigen::Index i = 0; i < state.body.velocity.size(); ++i)
    state.body.velocity[i] = 1.5 * std::sin(3.0 * double(i) + 1);
  ragdoll.limbs.pairs.clear();
  RagdollOptions options{.step = 1.0 / 1000, .gravity = 0, .ground = false};
  Vec3 push, push_then;
  const Vec3 spin = angular_momentum(ragdoll, state.body, push);
  body_frames(ragdoll.body, state.body.pose, state.frames);
  const double energy = body_energy(ragdoll.body, state.body, state.frames, 0);
  for (int k = 0; k < 500; ++k) step_ragdoll(ragdoll, options, state);
  const Vec3 spin_then = angular_momentum(ragdoll, state.body, push_then);
  body_frames(ragdoll.body, state.body.pose, state.frames);
  const double energy_then = body_energy(ragdoll.body, state.body, state.frames, 0);
  EXPECT_LT((push_then - push).norm(), 0.01 * push.norm());
  EXPECT_LT((spin_then - spin).norm(), 0.01 * spin.norm());
  EXPECT_NEAR(energy_then, energy, 0.01 * energy);
}

TEST(Ragdoll, FreeFallTakesItsTime) {
  Ragdoll ragdoll = box({0.2, 0.1, 0.3}, 20);
  FallOptions options = seconds(1.5);
  options.longest_step = 1e-3, options.frictionless = true;
  const FallResult fallen = fall(ragdoll, lying(ragdoll, 1), options);
  const double taken = std::sqrt(2 * 1.006 / kG);
  EXPECT_NEAR(fallen.touch, taken, 0.01 * taken);
  const std::size_t before = std::size_t(0.9 * taken * 60);
  EXPECT_NEAR(fallen.energies[before], fallen.energies[0], 0.01 * fallen.energies[0]);
  EXPECT_NEAR(fallen.end_force, 20 * kG, 0.01 * 20 * kG);
}

TEST(Ragdoll, BoxAtRestStaysAtRest) {
  const Ragdoll ragdoll = box({0.2, 0.1, 0.3}, 20);
  const FallResult fallen = fall(ragdoll, lying(ragdoll, -0.006), seconds(2));
  EXPECT_LT((fallen.motion.frames.back().root - fallen.motion.frames.front().root).norm(), 1e-4);
  EXPECT_LT(fallen.end_speed, 1e-6);
  EXPECT_NEAR(fallen.end_force, fallen.weight, 1e-6 * fallen.weight);
}

TEST(Ragdoll, FrictionStopsASlidingBox) {
  const Ragdoll ragdoll = box({0.2, 0.02, 0.3}, 20);
  BodyState start = lying(ragdoll, -0.006);
  start.velocity[0] = 2;
  const FallResult fallen = fall(ragdoll, start, seconds(1));
  const double way = 2 * 2 / (2 * 0.5 * kG);
  EXPECT_NEAR(fallen.motion.frames.back().root.x(), way, 0.02 * way);
}

// A rod hung at its end from a joint that is driven, turned by an angle and let go.
constexpr double kRod = 0.5;  // m

Ragdoll hung_rod(double angle, RagdollState& state) {
  const double mass = 3;
  Ragdoll ragdoll;
  ArticulatedModel& body = ragdoll.body;
  body.skeleton.joints = {free_joint("held", -1, Vec3(0, 1, 0)),
                          free_joint("rod", 0, Vec3::Zero())};
  const double across = mass * kRod * kRod / 12;
  body.segments = {
      {"rod", 1, mass, Vec3(0, -kRod / 2, 0), Vec3(across, 1e-3, across).asDiagonal()}};
  body.groups = {{{1}, {Vec3::Ones()}, 1, 0, 0, 0}};
  state.body.pose = rest_pose(body.skeleton);
  state.rest = set_frictionless(state.body.pose, body);
  body.driven = {1, 0};
  state.body.driven.resize(2);
  state.body.velocity.setZero(1);
  state.body.pose.rotations[1] = Eigen::AngleAxisd(angle, Vec3::UnitX());
  return ragdoll;
}

TEST(Ragdoll, RodKeepsItsEnergyAtTheStepOfFalls) {
  RagdollState state;
  const Ragdoll ragdoll = hung_rod(1.5, state);
  const RagdollOptions options{.ground = false};
  double low = 0, high = 0, first = 0;
  for (int k = 0; k < 1200; ++k) {
    BodyState now = state.body;
    now.velocity = pose_velocity(state);
    body_frames(ragdoll.body, now.pose, state.frames);
    const double energy = body_energy(ragdoll.body, now, state.frames, options.gravity);
    if (k == 0) low = high = first = energy;
    low = std::min(low, energy), high = std::max(high, energy);
    step_ragdoll(ragdoll, options, state);
  }
  const double fallen = 3 * kG * kRod / 2;
  EXPECT_LT(high - low, 1e-3 * fallen) << first;
}

TEST(Ragdoll, RodSwingsInItsPeriod) {
  const double length = kRod;
  RagdollState state;
  const Ragdoll ragdoll = hung_rod(0.1, state);
  const RagdollOptions options{.step = 1e-3, .ground = false};
  double first = 0, last = 0;
  int count = 0;
  for (double before = 0; state.time < 12; before = state.body.velocity[0]) {
    step_ragdoll(ragdoll, options, state);
    if (!(before < 0 && state.body.velocity[0] >= 0)) continue;
    (count++ ? last : first) = state.time;
  }
  const double period = 2 * std::numbers::pi * std::sqrt(2 * length / (3 * kG));
  const double amplitude = 1 + 0.1 * 0.1 / 16;
  EXPECT_NEAR((last - first) / (count - 1), amplitude * period, 1e-3 * period);
}

TEST(Ragdoll, FallsWithinItsLimitsAndLiesStill) {
  const Ragdoll ragdoll = person();
  for (const Vec3& push : {Vec3(0, 0, 1), Vec3(1, 0, -0.7)}) {
    FallOptions options;
    options.push = push, options.seconds = 5, options.fps = 30;
    const FallResult fallen = fall(ragdoll, lying(ragdoll, 0.3), options);
    EXPECT_LT(fallen.limit_excess, 0.5 * kDegree);
    EXPECT_LT(fallen.deepest, 0.02);
    EXPECT_LT(fallen.overlap, 0.03);
    EXPECT_LT(fallen.end_speed, 0.01);
    EXPECT_NEAR(fallen.end_force, fallen.weight, 0.01 * fallen.weight);
    EXPECT_LT(fallen.motion.frames.back().root.y(), 0.25);
  }
}

TEST(Ragdoll, HalfTheStepEndsAlike) {
  const Ragdoll ragdoll = person();
  FallOptions options;
  options.tone = 0.3, options.push = Vec3(0.2, 0, 1), options.seconds = 3, options.fps = 30;
  FallOptions half = options;
  half.longest_step = options.longest_step / 2;
  std::vector<Transform> one, other;
  const Skeleton& skeleton = ragdoll.body.skeleton;
  forward_kinematics(skeleton, fall(ragdoll, lying(ragdoll, 0), options).motion.frames.back(), one);
  forward_kinematics(skeleton, fall(ragdoll, lying(ragdoll, 0), half).motion.frames.back(), other);
  for (const char* name : {"pelvis", "head", "elbow_l", "wrist_r", "knee_l", "ankle_r"}) {
    const std::size_t j = std::size_t(joint_of(skeleton, name));
    EXPECT_LT((one[j].translation() - other[j].translation()).norm(), 0.01) << name;
  }
}

TEST(Ragdoll, SymmetricFallStaysSymmetric) {
  const Ragdoll ragdoll = person();
  FallOptions options;
  options.push = Vec3(0, 0, 1), options.seconds = 2, options.fps = 30;
  const FallResult fallen = fall(ragdoll, lying(ragdoll, 0.2), options);
  std::vector<Transform> X;
  for (const Pose& pose : fallen.motion.frames) {
    forward_kinematics(ragdoll.body.skeleton, pose, X);
    for (const std::string name : {"wrist", "knee", "ankle"}) {
      const auto at = [&](const char* side) {
        return X[std::size_t(joint_of(ragdoll.body.skeleton, name + side))].translation();
      };
      const Vec3 left = at("_l"), right = at("_r");
      EXPECT_LT((left - Vec3(-right.x(), right.y(), right.z())).norm(), 1e-3) << name;
    }
  }
}

TEST(Ragdoll, LimpArmHangsAndTheRestGoesOn) {
  const Ragdoll ragdoll = person();
  const Skeleton& skeleton = ragdoll.body.skeleton;
  Motion motion;
  motion.fps = 30;
  for (int f = 0; f < 150; ++f) {
    motion.frames.push_back(rest_pose(skeleton));
    motion.frames.back().rotations[std::size_t(joint_of(skeleton, "shoulder_l"))] = joint_rotation(
        skeleton.joints[std::size_t(joint_of(skeleton, "shoulder_l"))], Vec3(1.2, 0.6, 0));
    motion.frames.back().root.x() += 0.01 * f;
  }
  const LimpResult limp = limp_motion(ragdoll, motion, {"shoulder_l"}, {.ground = false});
  EXPECT_EQ(limp.joints.size(), 4u);
  EXPECT_LT(limp.limit_excess, 0.5 * kDegree);
  std::vector<Transform> X;
  forward_kinematics(skeleton, limp.motion.frames.back(), X);
  const auto at = [&](const char* name) {
    return X[std::size_t(joint_of(skeleton, name))].translation();
  };
  const Vec3 arm = (at("elbow_l") - at("shoulder_l")).normalized();
  EXPECT_LT(arm.y(), -0.9);
  const std::size_t knee = std::size_t(joint_of(skeleton, "knee_l"));
  EXPECT_EQ(limp.motion.frames[70].rotations[knee].coeffs(),
            motion.frames[70].rotations[knee].coeffs());
  EXPECT_THROW(limp_motion(ragdoll, motion, {"pelvis"}, {}), std::invalid_argument);
  EXPECT_THROW(limp_motion(ragdoll, motion, {"dip2_l"}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace ecorche
