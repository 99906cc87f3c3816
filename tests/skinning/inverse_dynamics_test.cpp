// Newton's laws on our skeleton: what falls freely needs no force, a pendulum's moment is the
// textbook's, a body that stands presses with its weight, and recorded and own motions ask of the
// ground what plates have measured of such motions.
#include "skinning/dynamics/inverse_dynamics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "skinning/dynamics/compare_ground.h"
#include "skinning/dynamics/segment_inertia.h"
#include "skinning/dynamics/smooth_motion.h"
#include "skinning/dynamics/supported_path.h"
#include "skinning/motion/center_of_mass.h"
#include "skinning/motion_files/read_motion.h"
#include "skinning/retarget/retarget.h"
#include "tests/skinning/plain_skeleton.h"

using namespace ecorche;

namespace {

namespace fs = std::filesystem;

constexpr double kSole = -0.82;

// Three links with centres and inertias of their own.
struct Chain {
  Skeleton skeleton;
  std::vector<BodySegment> segments;
};

Chain make_chain() {
  Chain out;
  for (int j = 0; j < 3; ++j) {
    Joint joint;
    joint.name = "link" + std::to_string(j);
    joint.parent = j - 1;
    joint.X_PJ.translation() = j > 0 ? Vec3(0.1, -0.4, 0.05) : Vec3(0, 1, 0);
    out.skeleton.joints.push_back(joint);
    Mat3 inertia = Vec3(0.10, 0.03, 0.12).asDiagonal();
    inertia(0, 1) = inertia(1, 0) = 0.01;
    out.segments.push_back({joint.name, j, 3.0 - j, Vec3(0.02, -0.2, 0.01 * j), inertia});
  }
  return out;
}

// A motion with turns in every joint, and its derivatives, by a formula.
MotionState chain_state(double t) {
  MotionState state;
  const double w = 3;
  state.pose.root = {0.3 * std::sin(w * t), 1 + 0.1 * std::cos(w * t), 0.2 * t};
  state.root_velocity = {0.3 * w * std::cos(w * t), -0.1 * w * std::sin(w * t), 0.2};
  state.root_acceleration = {-0.3 * w * w * std::sin(w * t), -0.1 * w * w * std::cos(w * t), 0};
  for (int j = 0; j < 3; ++j) {
    const Vec3 axis = Vec3(1, 0.5 * j, 1 - j).normalized();
    const double phase = w * t + j;
    state.pose.rotations.emplace_back(Eigen::AngleAxisd(0.8 * std::sin(phase), axis));
    state.rates.push_back(0.8 * w * std::cos(phase) * axis);
    state.turn_accelerations.push_back(-0.8 * w * w * std::sin(phase) * axis);
  }
  return state;
}

// Point masses with small inertias, as a body of 70 kg.
std::vector<BodySegment> winter_segments(const Skeleton& skeleton) {
  std::vector<BodySegment> out;
  const CenterOfMass center(skeleton);
  for (const CenterOfMass::Segment& s : center.segments())
    out.push_back({"", s.joint, 70 * s.mass, s.centre, 70 * s.mass * 0.01 * Mat3::Identity()});
  return out;
}

Motion retargeted(const Skeleton& skeleton, const fs::path& file) {
  RetargetOptions options;
  options.sole_height = kSole;
  RetargetReport report;
  return retarget(read_motion(file), skeleton, options, report);
}

}  // namespace

TEST(JointLoads, RootForceIsTheChangeOfMomentum) {
  const Chain chain = make_chain();
  const double h = 1e-4;
  for (const double t : {0.0, 0.4, 1.3}) {
    BodyLoads before, now, after;
    find_joint_loads(chain.skeleton, chain.segments, chain_state(t - h), {}, before);
    find_joint_loads(chain.skeleton, chain.segments, chain_state(t), {}, now);
    find_joint_loads(chain.skeleton, chain.segments, chain_state(t + h), {}, after);
    const double mass = now.momentum.mass;
    const Vec3 force = mass * ((after.momentum.velocity - before.momentum.velocity) / (2 * h) +
                               Vec3(0, kGravity, 0));
    EXPECT_LT((now.joints[0].force - force).norm(), 1e-4 * force.norm());
    const Vec3 arm = now.momentum.center - now.X_WJ[0].translation(),
               moment =
                   (after.momentum.angular - before.momentum.angular) / (2 * h) + arm.cross(force);
    EXPECT_LT((now.joints[0].moment - moment).norm(), 1e-4 * moment.norm());
    // velocity is the change of place
    EXPECT_LT(
        ((after.momentum.center - before.momentum.center) / (2 * h) - now.momentum.velocity).norm(),
        1e-5);
    // what joints give and the root's force do is the change of energy
    const auto energy = [&](const BodyLoads& loads) {
      return loads.momentum.kinetic_energy + mass * kGravity * loads.momentum.center.y();
    };
    const MotionState state = chain_state(t);
    const double work = now.power[1] + now.power[2] + now.joints[0].force.dot(state.root_velocity) +
                        now.joints[0].moment.dot(state.rates[0]);
    EXPECT_NEAR(work, (energy(after) - energy(before)) / (2 * h), 1e-3 * std::abs(work) + 1e-3);
  }
}

TEST(JointLoads, ForcesFromOutsideAreTakenOff) {
  const Chain chain = make_chain();
  BodyLoads free, held;
  find_joint_loads(chain.skeleton, chain.segments, chain_state(0.2), {}, free);
  const ExternalForce force{2, {0.4, 0.1, -0.2}, {10, 50, -5}, {1, -2, 3}};
  find_joint_loads(chain.skeleton, chain.segments, chain_state(0.2), std::span(&force, 1), held);
  for (const int j : {0, 1, 2}) {
    const Vec3 arm = force.place - free.X_WJ[j].translation();
    EXPECT_LT((free.joints[j].force - held.joints[j].force - force.force).norm(), 1e-10);
    EXPECT_LT(
        (free.joints[j].moment - held.joints[j].moment - force.moment - arm.cross(force.force))
            .norm(),
        1e-10);
  }
}

TEST(JointLoads, PendulumIsTheTextbooks) {
  Chain chain = make_chain();
  chain.segments = {{"bob", 1, 2.0, {0, -0.5, 0}, 0.05 * Mat3::Identity()}};
  for (const double t : {0.0, 0.3, 0.7}) {
    const double w = 4, angle = 0.6 * std::sin(w * t), turning = -w * w * angle;
    MotionState state;
    state.pose = rest_pose(chain.skeleton);
    state.pose.rotations[1] = Quat(Eigen::AngleAxisd(angle, Vec3::UnitX()));
    state.rates.assign(3, Vec3::Zero());
    state.turn_accelerations = state.rates;
    state.rates[1].x() = 0.6 * w * std::cos(w * t);
    state.turn_accelerations[1].x() = turning;
    BodyLoads loads;
    find_joint_loads(chain.skeleton, chain.segments, state, {}, loads);
    const double textbook = (0.05 + 2.0 * 0.25) * turning + 2.0 * kGravity * 0.5 * std::sin(angle);
    EXPECT_NEAR(loads.joints[1].moment.x(), textbook, 1e-12);
  }
}

TEST(SmoothMotion, LowPassKeepsWhatIsSlowAndDoesNotLag) {
  const double fps = 120, cutoff = 6;
  const auto gain = [&](double hertz) {
    Eigen::MatrixXd x(480, 1);
    for (Eigen::Index i = 0; i < x.rows(); ++i)
      x(i, 0) = std::sin(2 * std::numbers::pi * hertz * double(i) / fps);
    const Eigen::VectorXd was = x.col(0).segment(120, 240);
    low_pass(fps, cutoff, x);
    // in phase with what went in
    return x.col(0).segment(120, 240).dot(was) / was.squaredNorm();
  };
  EXPECT_NEAR(gain(1), 1, 0.01);
  EXPECT_NEAR(gain(6), std::numbers::sqrt2 / 2, 0.01);
  EXPECT_LT(gain(20), 0.03);
}

TEST(SmoothMotion, StraightLinesStay) {
  Eigen::MatrixXd x(50, 1);
  for (Eigen::Index i = 0; i < x.rows(); ++i) x(i, 0) = 3 + 0.2 * double(i);
  const Eigen::MatrixXd was = x;
  low_pass(60, 6, x);
  EXPECT_LT((x - was).cwiseAbs().maxCoeff(), 5e-3);
}

TEST(InverseDynamics, WhatFallsAndSpinsNeedsNoForce) {
  const Skeleton skeleton = plain_skeleton();
  std::vector<BodySegment> segments = winter_segments(skeleton);
  // a rigid body turns evenly about a principal axis: it is symmetric, so the vertical is one only
  // nearly; one far heavier ball at its place makes it one
  for (BodySegment& s : segments) s.mass *= 1e-6;
  for (BodySegment& s : segments) s.inertia *= 1e-6;
  segments.push_back({"ball", 0, 70, {0.1, 0.2, -0.1}, 2 * Mat3::Identity()});
  Motion motion{240, {}};
  const Vec3 arm = segments.back().center;
  for (int f = 0; f < 240; ++f) {
    const double t = f / motion.fps;
    Pose pose = rest_pose(skeleton);
    pose.rotations[0] = Quat(Eigen::AngleAxisd(2.5 * t, Vec3(1, 2, 0.5).normalized()));
    const Vec3 center(1.5 * t, 3 + 4 * t - 0.5 * kGravity * t * t, -0.3 * t);
    pose.root = center - pose.rotations[0] * arm;
    motion.frames.push_back(pose);
  }
  DynamicsOptions options;
  options.cutoff = 0;
  const MotionDynamics found = inverse_dynamics(skeleton, segments, kSole, motion, options);
  EXPECT_LT(found.residual_force_peak, 2e-3);
  EXPECT_LT(found.residual_moment_rms, 1e-3);
  EXPECT_EQ(found.peak_vertical, 0);
  EXPECT_GT(found.flight_frames, 200);
}

TEST(InverseDynamics, StandingIsTheWeight) {
  const Skeleton skeleton = plain_skeleton();
  const std::vector<BodySegment> segments = winter_segments(skeleton);
  Motion motion{60, std::vector<Pose>(60, rest_pose(skeleton))};
  const MotionDynamics found = inverse_dynamics(skeleton, segments, kSole, motion);
  EXPECT_EQ(found.cutoff, kWalkingCutoff);
  EXPECT_NEAR(found.mean_vertical, 1, 1e-3);
  EXPECT_LT(found.residual_force_rms, 1e-3);
  EXPECT_LT(found.residual_moment_rms, 1e-3);
  const DynamicsFrame& frame = found.frames[30];
  EXPECT_NEAR(frame.feet[0].force.y(), frame.feet[1].force.y(), 0.02 * found.weight);
  // the centre of pressure lies below the centre of mass
  const Vec3 pressed = (frame.feet[0].force.y() * frame.feet[0].place +
                        frame.feet[1].force.y() * frame.feet[1].place) /
                       (frame.feet[0].force.y() + frame.feet[1].force.y());
  EXPECT_LT((pressed - frame.loads.momentum.center).head<1>().norm(), 1e-3);
  EXPECT_LT((pressed - frame.loads.momentum.center).tail<1>().norm(), 1e-3);
}

TEST(InverseDynamics, LongJumpFliesOnItsParabola) {
  const Skeleton skeleton = plain_skeleton();
  const Motion jump =
      retargeted(skeleton, fs::path(ECORCHE_TEST_DIR) / "../data/motions/long_jump.bvh");
  const MotionDynamics found = inverse_dynamics(skeleton, winter_segments(skeleton), kSole, jump);
  EXPECT_EQ(found.cutoff, kFlyingCutoff);
  EXPECT_GT(found.peak_vertical, 3);
  EXPECT_LT(found.peak_vertical, 5);
  // the longest flight, without its ends, where smoothing mixes it with the ground
  std::size_t begin = 0, end = 0;
  for (std::size_t f = 0; f < found.frames.size(); ++f) {
    std::size_t g = f;
    while (g < found.frames.size() && found.frames[g].contact < 1e-3) ++g;
    if (g - f > end - begin) begin = f, end = g;
    f = std::max(f, g);
  }
  const std::size_t margin = std::size_t(0.08 * found.fps);
  ASSERT_GT(end - begin, 4 * margin);
  begin += margin;
  end -= margin;
  const BodyMomentum& start = found.frames[begin].loads.momentum;
  for (std::size_t f = begin; f < end; ++f) {
    const double t = double(f - begin) / found.fps;
    const Vec3 fall = start.center + t * start.velocity - 0.5 * kGravity * t * t * Vec3::UnitY();
    EXPECT_LT((found.frames[f].loads.momentum.center - fall).norm(), 0.01) << f;
  }
}

TEST(InverseDynamics, RecordedWalkHasTwoPeaks) {
  const fs::path file =
      fs::path(ECORCHE_SHARED_DIR) / "testdata/motion/cmu_cgspeed31/02_01_walk.bvh";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not here";
  const Skeleton skeleton = plain_skeleton();
  const MotionDynamics found =
      inverse_dynamics(skeleton, winter_segments(skeleton), kSole, retargeted(skeleton, file));
  EXPECT_EQ(found.cutoff, kWalkingCutoff);
  EXPECT_NEAR(found.mean_vertical, 1, 0.1);
  // Every whole stance has two peaks with a valley between. The skeleton's soles are rough, so the
  // peaks are a little lower than a body's (docs/dynamics.md).
  int stances = 0;
  for (const std::size_t foot : {0, 1}) {
    std::vector<double> force;
    for (const DynamicsFrame& frame : found.frames)
      force.push_back(frame.feet[foot].force.y() / found.weight);
    for (std::size_t f = 1; f < force.size(); ++f) {
      if (!(force[f - 1] < 0.05 && force[f] >= 0.05)) continue;
      std::size_t end = f;
      while (end < force.size() && force[end] >= 0.05) ++end;
      const std::size_t length = end - f;
      if (end == force.size() || double(length) < 0.4 * found.fps) continue;
      const auto most = [&](std::size_t a, std::size_t b) {
        return *std::max_element(force.begin() + long(a), force.begin() + long(b));
      };
      const double first = most(f, f + length * 2 / 5), second = most(end - length * 2 / 5, end),
                   valley = *std::min_element(force.begin() + long(f + length / 3),
                                              force.begin() + long(end - length / 3));
      EXPECT_GT(first, 0.85) << f;
      EXPECT_LT(first, 1.35) << f;
      EXPECT_GT(second, 0.9) << f;
      EXPECT_LT(second, 1.35) << f;
      EXPECT_LT(valley, 0.95 * std::min(first, second)) << f;
      ++stances;
    }
  }
  EXPECT_GE(stances, 1);
}

TEST(SupportedPath, BouncesAreParabolasAndPushes) {
  // A push of a half sine of 0.25 s, then 0.1 s of flight, again and again.
  constexpr double kFps = 200, kPush = 0.25, kFlight = 0.1, kStep = kPush + kFlight;
  const double peak = kGravity * kStep / kPush * std::numbers::pi / 2;
  const auto push = [&](double t) {
    const double in = std::fmod(t, kStep);
    return in < kPush ? peak * std::sin(std::numbers::pi * in / kPush) : 0;
  };
  // seen with an error of 1 mm at 8 Hz, which is 2.5 m/s^2
  std::vector<Vec3> seen;
  std::vector<double> contact;
  constexpr int kSub = 50;
  double y = 1, v = -0.5 * kGravity * kFlight;
  for (int f = 0; f < 280; ++f) {
    seen.emplace_back(0, y + 1e-3 * std::sin(16 * std::numbers::pi * f / kFps), 2 * f / kFps);
    contact.push_back(std::fmod(f / kFps, kStep) < kPush + 1e-9);
    for (int k = 0; k < kSub; ++k) {
      const double h = 1 / (kFps * kSub), a = push(f / kFps + (k + 0.5) * h) - kGravity;
      y += v * h + 0.5 * a * h * h;
      v += a * h;
    }
  }
  const SupportedPath path = supported_path(seen, contact, kFps, 15);
  EXPECT_LT(path.moved, 3e-3);
  double off = 0;
  for (std::size_t f = 10; f + 10 < seen.size(); ++f) {
    if (contact[f - 1] + contact[f] + contact[f + 1] == 0) {
      const Vec3 bend = path.place[f + 1] - 2 * path.place[f] + path.place[f - 1];
      EXPECT_NEAR(kFps * kFps * bend.y(), -kGravity, 0.8) << f;
    }
    off += std::pow(path.acceleration[f].y() + kGravity - push(double(f) / kFps), 2);
  }
  EXPECT_LT(std::sqrt(off / double(seen.size() - 20)), 0.25 * kGravity);
}

TEST(InverseDynamics, ATreadmillIsAFloorThatMoves) {
  const Skeleton skeleton = plain_skeleton();
  const Motion walk = retargeted(skeleton, fs::path(ECORCHE_TEST_DIR) / "../data/motions/walk.bvh");
  const std::vector<BodySegment> segments = winter_segments(skeleton);
  Motion moved = walk;
  const Vec3 belt(0.3, 0, -1.4);
  for (std::size_t f = 0; f < moved.frames.size(); ++f)
    moved.frames[f].root += double(f) / moved.fps * belt;
  const MotionDynamics floor = inverse_dynamics(skeleton, segments, kSole, walk),
                       treadmill = inverse_dynamics(skeleton, segments, kSole, moved);
  EXPECT_EQ(floor.belt, Vec3(Vec3::Zero()));
  EXPECT_LT((treadmill.belt - belt).norm(), 0.15);
  std::vector<std::array<FootForce, 2>> feet;
  for (const DynamicsFrame& frame : floor.frames) feet.push_back(frame.feet);
  const GroundComparison same = compare_ground(treadmill, feet);
  EXPECT_LT(same.both.vertical_rms, 0.05);
  EXPECT_NEAR(same.measured_mean, 1, 0.05);
  // measured forces are taken as they are, and are nothing else than the estimate's
  const MotionDynamics measured =
      inverse_dynamics(skeleton, segments, kSole, walk, {-1, true, feet});
  EXPECT_LT(compare_ground(measured, feet).both.vertical_rms, 1e-12);
  EXPECT_NEAR(measured.residual_force_rms, floor.residual_force_rms, 1e-9);
  // a foot that stands beside the plates for a while is left out for so long
  EXPECT_EQ(compare_ground(floor, feet).beside, 0);
  for (std::size_t f = 0; f < feet.size() / 2 || feet[f][0].force.y() > 0; ++f) feet[f][0] = {};
  const GroundComparison beside = compare_ground(floor, feet);
  EXPECT_GE(beside.beside, 2);
  EXPECT_LT(beside.both.vertical_rms, 0.15);
  EXPECT_LT(beside.compared[2], 0.9);
  EXPECT_NEAR(beside.compared[1], 1, 1e-9);
}
