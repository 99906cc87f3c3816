#include "skinning/ragdoll/fall.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "anatomy/compute/cholesky.h"
#include "anatomy/compute/cross_matrix.h"
#include "anatomy/joint_angles.h"
#include "skinning/motion/require_joint.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kEndSeconds = 0.25;     // at the end, over which force and speed are told
constexpr double kFingerSeconds = 0.15;  // in which limp fingers curl
// What is slower for so long stays as it lies.
constexpr double kAsleepSpeed = 0.004, kAsleepSeconds = 0.5;  // m/s, s
constexpr double kStill = 0.01;                               // m/s

// The shove's impulse is the least that moves the chest so.
void shove(const Ragdoll& ragdoll, const FallOptions& options, RagdollState& state) {
  if (options.push.isZero()) return;
  const Skeleton& skeleton = ragdoll.body.skeleton;
  body_frames(ragdoll.body, state.body.pose, state.frames);
  body_forces(ragdoll.body, state.rest, state.body, state.frames, 0, state.forces);
  const std::size_t thorax = std::size_t(joint_of(skeleton, "thorax")),
                    neck = std::size_t(joint_of(skeleton, "c7"));
  const Vec3 arm =
      0.5 * (state.frames.X_WJ[neck].translation() - state.frames.X_WJ[thorax].translation());
  const Eigen::MatrixXd& J = state.frames.jacobian[thorax];
  const Eigen::MatrixXd point = J.bottomRows<3>() - cross_matrix(arm) * J.topRows<3>();
  const CholeskyFactor inertia(state.forces.inertia + options.world.step * state.forces.damping);
  const Eigen::MatrixXd yields = inertia.solve_columns(point.transpose());
  const Mat3 compliance = point * yields;
  state.body.velocity += yields * solve_ldlt<3>(compliance, options.push);
}

double fastest_joint(const ArticulatedModel& body, const RagdollState& state) {
  double fastest = 0;
  for (const BodySegment& segment : body.segments)
    fastest = std::max(fastest, (state.frames.jacobian[std::size_t(segment.joint)].bottomRows<3>() *
                                 state.body.velocity)
                                    .norm());
  return fastest;
}

void measure_frame(const Ragdoll& ragdoll, const FallOptions& options, RagdollState& state,
                   FallResult& out) {
  body_frames(ragdoll.body, state.body.pose, state.frames);
  out.energies.push_back(
      body_energy(ragdoll.body, state.body, state.frames, options.world.gravity));
  for (const PassiveJoint& group : ragdoll.body.groups)
    for (const int j : group.joints) {
      const Joint& joint = ragdoll.body.skeleton.joints[std::size_t(j)];
      const double excess = limit_excess(joint, state.body.pose.rotations[std::size_t(j)]);
      if (excess <= out.limit_excess) continue;
      out.limit_excess = excess;
      out.worst_joint = joint.name;
    }
  if (options.world.ground)
    out.deepest = std::max(out.deepest,
                           options.world.ground_height - lowest_point(ragdoll, state.frames.X_WJ));
  for (const double depth : penetration_depths(ragdoll.limbs, state.frames.X_WJ))
    out.overlap = std::max(out.overlap, depth);
  out.motion.frames.push_back(state.body.pose);
}

}  // namespace

FallResult fall(Ragdoll ragdoll, BodyState start, const FallOptions& given,
                const std::function<void(double)>& progress) {
  FallOptions options = given;
  const int steps = std::max(1, int(std::ceil(1 / (options.fps * options.longest_step) - 1e-9)));
  const double h = options.world.step = 1 / (options.fps * steps);
  FallResult out;
  out.motion.fps = options.fps;
  out.weight = ragdoll.body.mass() * options.world.gravity;
  RagdollState state;
  state.body = std::move(start);
  if (state.body.velocity.size() == 0) state.body.velocity.setZero(ragdoll.body.freedoms());
  state.rest = options.frictionless ? set_frictionless(state.body.pose, ragdoll.body)
                                    : set_tone(options.tone, state.body.pose, ragdoll.body);
  shove(ragdoll, options, state);
  measure_frame(ragdoll, options, state, out);
  const int frames = int(std::lround(options.seconds * options.fps));
  const double curl =
      options.frictionless ? 0 : (1 - options.tone) * (1 - std::exp(-h / kFingerSeconds));
  bool awake = true;
  double slow_seconds = 0, force_sum = 0;
  int force_count = 0;
  for (int f = 1; f <= frames; ++f) {
    double frame_force = 0;
    for (int s = 0; s < steps; ++s) {
      if (awake) {
        step_ragdoll(ragdoll, options.world, state);
        loosen_fingers(ragdoll, curl, state.body.pose);
      } else {
        state.time += h;
      }
      const double force = state.ground_force.y();
      if (out.touch < 0 && force > 0) out.touch = state.time - h;
      frame_force += force / steps;
      const double speed = fastest_joint(ragdoll.body, state);
      slow_seconds = speed < kAsleepSpeed && force > 0 ? slow_seconds + h : 0;
      if (awake && slow_seconds > kAsleepSeconds) {
        awake = false;
        state.body.velocity.setZero();
      }
      if (speed > kStill) out.rest = -1;
      if (speed <= kStill && out.rest < 0) out.rest = state.time;
      if (state.time < options.seconds - kEndSeconds) continue;
      force_sum += force;
      ++force_count;
      out.end_speed = std::max(out.end_speed, speed);
    }
    out.peak_force = std::max(out.peak_force, frame_force);
    measure_frame(ragdoll, options, state, out);
    if (progress) progress(double(f) / frames);
  }
  out.end_force = force_sum / std::max(1, force_count);
  return out;
}

void put_at_height(const Ragdoll& ragdoll, double height, Pose& pose) {
  std::vector<Transform> X_WJ;
  forward_kinematics(ragdoll.body.skeleton, pose, X_WJ);
  pose.root.y() += height - lowest_point(ragdoll, X_WJ);
}

}  // namespace ecorche::inline v1
