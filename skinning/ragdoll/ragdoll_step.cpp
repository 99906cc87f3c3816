#include "skinning/ragdoll/ragdoll_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "anatomy/compute/cross_matrix.h"
#include "anatomy/joint_angles.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kSoftness = 0.003;   // of constraints, of what the body itself yields
constexpr double kReturn = 0.15;      // share of what is too deep that a step takes back
constexpr double kReturnSpeed = 0.3;  // m/s, at most
constexpr double kReturnTurn = 1;     // rad/s, likewise of joints
constexpr double kNear = 0.005;       // m from the ground that count as a contact
constexpr double kLimitNear = 0.1;    // rad from a limit, likewise
// Beyond a limit by more is how a body began: it returns at kReturnTurn.
constexpr double kOvershoot = 3 * kDegree;
constexpr double kStrike = 0.5;        // m/s
constexpr int kParts = 6;              // of a step in which skin strikes the ground
constexpr double kSkinFriction = 0.3;  // of limbs on each other

// Velocity across a gap that is left or, below 0, too deep.
double gap_target(double gap, double step, double most) {
  return gap > 0 ? -gap / step : std::min(-kReturn * gap / step, most);
}

// Adds to three columns the velocity of a joint's point along three directions.
void add_point(const BodyFrames& frames, int joint, const Vec3& arm, double sign, const Mat3& axes,
               int first, ConeSolver& solver) {
  const Eigen::MatrixXd& J = frames.jacobian[std::size_t(joint)];
  for (int k = 0; k < 3; ++k) {
    const Vec3 way = sign * axes.col(k), turn = arm.cross(way);
    auto column = solver.column(first + k);
    column.noalias() += J.bottomRows<3>().transpose() * way;
    column.noalias() += J.topRows<3>().transpose() * turn;
  }
}

// Velocities at the end of the step that driven joints give those below.
void find_carried(const Ragdoll& ragdoll, double step, RagdollState& state) {
  const ArticulatedModel& body = ragdoll.body;
  state.carried.assign(body.skeleton.joints.size(), {});
  if (body.driven.empty()) return;
  for (std::size_t j = 0; j < state.carried.size(); ++j) {
    JointMotion& out = state.carried[j];
    if (body.driven[j]) {
      out = state.body.driven[j];
      out.turn += step * out.turn_rate;
      out.origin += step * out.origin_rate;
      continue;
    }
    const std::size_t p = std::size_t(body.skeleton.joints[j].parent);
    const Vec3 r = state.frames.X_WJ[j].translation() - state.frames.X_WJ[p].translation();
    out.turn = state.carried[p].turn;
    out.origin = state.carried[p].origin + out.turn.cross(r);
  }
}

Vec3 carried_velocity(const RagdollState& state, int joint, const Vec3& arm) {
  const JointMotion& at = state.carried[std::size_t(joint)];
  return at.origin + at.turn.cross(arm);
}

bool moves(const Ragdoll& ragdoll, int joint) {
  return ragdoll.body.driven.empty() || !ragdoll.body.driven[std::size_t(joint)];
}

void add_ground(const Ragdoll& ragdoll, const RagdollOptions& options, RagdollState& state) {
  state.grounded.clear();
  if (!options.ground) return;
  Mat3 axes;
  axes << 0, 1, 0, 1, 0, 0, 0, 0, 1;
  for (const CarriedPoint& point : ragdoll.points) {
    if (!moves(ragdoll, point.joint)) continue;
    const Transform& X = state.frames.X_WJ[std::size_t(point.joint)];
    const Vec3 arm = X.linear() * point.place;
    const double gap = X.translation().y() + arm.y() - options.ground_height + options.flesh;
    const JointMotion& motion = state.forces.motion[std::size_t(point.joint)];
    const double sinking = -(motion.origin + motion.turn.cross(arm)).y();
    if (gap > kNear + 2 * options.step * std::max(0.0, sinking)) continue;
    Vec3 target = -axes.transpose() * carried_velocity(state, point.joint, arm);
    target[0] += gap_target(gap, options.step, kReturnSpeed);
    const int first = state.solver.add_contact(options.friction, target);
    add_point(state.frames, point.joint, arm, 1, axes, first, state.solver);
    state.grounded.push_back(first);
  }
}

void add_meeting_limbs(const Ragdoll& ragdoll, const RagdollOptions& options, RagdollState& state) {
  find_proxy_contacts(ragdoll.limbs, state.frames.X_WJ, state.meeting);
  for (const ProxyContact& contact : state.meeting) {
    if (!moves(ragdoll, contact.joint) && !moves(ragdoll, contact.other_joint)) continue;
    Mat3 axes;
    axes.col(0) = contact.out;
    axes.col(1) = contact.out.unitOrthogonal();
    axes.col(2) = axes.col(0).cross(axes.col(1));
    const auto arm = [&](int joint) {
      return Vec3(contact.point - state.frames.X_WJ[std::size_t(joint)].translation());
    };
    const Vec3 mine = arm(contact.joint), other = arm(contact.other_joint);
    Vec3 target = -axes.transpose() * (carried_velocity(state, contact.joint, mine) -
                                       carried_velocity(state, contact.other_joint, other));
    target[0] += gap_target(-contact.depth, options.step, kReturnSpeed);
    const int first = state.solver.add_contact(kSkinFriction, target);
    add_point(state.frames, contact.joint, mine, 1, axes, first, state.solver);
    add_point(state.frames, contact.other_joint, other, -1, axes, first, state.solver);
  }
}

void add_limits(const Ragdoll& ragdoll, double step, RagdollState& state) {
  std::size_t at = 0;
  int column = ragdoll.body.root_freedoms();
  for (const PassiveJoint& group : ragdoll.body.groups) {
    for (const int j : group.joints) {
      const Joint& joint = ragdoll.body.skeleton.joints[std::size_t(j)];
      const TurningAngles& turning = state.forces.angles[at++];
      for (int a = group.first_axis; a < group.first_axis + group.axes; ++a)
        for (const double sign : {1.0, -1.0}) {
          const double angle = turning.angles[a];
          const double left = sign > 0 ? joint.max[a] - angle : angle - joint.min[a];
          if (left > kLimitNear) continue;
          const int k = state.solver.add_limit(gap_target(left, step, kReturnTurn));
          state.solver.column(k).segment(column, group.axes) =
              -sign * turning.by_turns.row(a).head(group.axes).transpose();
        }
    }
    column += group.axes;
  }
}

// What a fast joint went too far within the step, since its angles are not straight in its turns.
void keep_limits(const ArticulatedModel& body, Pose& pose) {
  for (const PassiveJoint& group : body.groups)
    for (const int j : group.joints) {
      const Joint& joint = body.skeleton.joints[std::size_t(j)];
      Quat& rotation = pose.rotations[std::size_t(j)];
      Vec3 angles = joint_angles(joint, rotation);
      bool beyond = false;
      for (int a = group.first_axis; a < group.first_axis + group.axes; ++a) {
        const double kept = std::clamp(angles[a], joint.min[a], joint.max[a]);
        if (kept == angles[a] || std::abs(kept - angles[a]) > kOvershoot) continue;
        angles[a] = kept;
        beyond = true;
      }
      if (beyond) rotation = joint_rotation(joint, angles).normalized();
    }
}

// One part of a step, of options.step.
void make_step(const Ragdoll& ragdoll, const RagdollOptions& options, RagdollState& state) {
  const double h = options.step, pushed = 0.5 * (state.last_step + h);
  body_frames(ragdoll.body, state.body.pose, state.frames);
  const Eigen::VectorXd before = state.body.velocity;
  state.body.velocity = pose_velocity(state);
  body_forces(ragdoll.body, state.rest, state.body, state.frames, options.gravity, state.forces);
  state.body.velocity = before;
  const BodyForces& forces = state.forces;
  state.system = forces.inertia + h * forces.damping + h * h * forces.stiffness;
  state.pushed.noalias() = forces.inertia * before;
  state.pushed += pushed * forces.force;
  state.solver.begin(state.system, state.pushed);
  find_carried(ragdoll, h, state);
  add_ground(ragdoll, options, state);
  add_meeting_limbs(ragdoll, options, state);
  add_limits(ragdoll, h, state);
  state.solver.solve(kSoftness, state.body.velocity);
  // What an impulse changes does not go on.
  if (state.solver.impulses().isZero(0))
    state.acceleration = (state.body.velocity - before) / pushed;
  else
    state.acceleration.setZero(before.size());
  state.last_step = h;
  advance_body(ragdoll.body, h, state.body);
  keep_limits(ragdoll.body, state.body.pose);
  state.time += h;
}

// Does skin come down on the ground within a step, faster than it settles? As it moved in the step
// before.
bool strikes_ground(const Ragdoll& ragdoll, const RagdollOptions& options,
                    const RagdollState& state) {
  if (!options.ground || state.forces.motion.empty()) return false;
  for (const CarriedPoint& point : ragdoll.points) {
    if (!moves(ragdoll, point.joint)) continue;
    const Transform& X = state.frames.X_WJ[std::size_t(point.joint)];
    const Vec3 arm = X.linear() * point.place;
    const JointMotion& motion = state.forces.motion[std::size_t(point.joint)];
    const double sinking = -(motion.origin + motion.turn.cross(arm)).y();
    if (sinking < kStrike) continue;
    const double gap = X.translation().y() + arm.y() - options.ground_height + options.flesh;
    if (gap > 0 && gap < 2.5 * options.step * sinking) return true;
  }
  return false;
}

}  // namespace

void step_ragdoll(const Ragdoll& ragdoll, const RagdollOptions& options, RagdollState& state) {
  const int parts = strikes_ground(ragdoll, options, state) ? kParts : 1;
  RagdollOptions part = options;
  part.step /= parts;
  state.ground_force.setZero();
  for (int k = 0; k < parts; ++k) {
    make_step(ragdoll, part, state);
    for (const int first : state.grounded) {
      const auto impulse = state.solver.impulses().segment<3>(first);
      state.ground_force += Vec3(impulse[1], impulse[0], impulse[2]) / options.step;
    }
  }
}

Eigen::VectorXd pose_velocity(const RagdollState& state) {
  if (state.acceleration.size() == 0) return state.body.velocity;
  return state.body.velocity + 0.5 * state.last_step * state.acceleration;
}

double lowest_point(const Ragdoll& ragdoll, const std::vector<Transform>& X_WJ) {
  double low = std::numeric_limits<double>::infinity();
  for (const CarriedPoint& point : ragdoll.points)
    low = std::min(low, (X_WJ[std::size_t(point.joint)] * point.place).y());
  return low;
}

}  // namespace ecorche::inline v1
