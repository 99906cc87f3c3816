#include "skinning/multibody/articulated_body.h"

#include <algorithm>
#include <cmath>

#include "anatomy/compute/cross_matrix.h"
#include "anatomy/joint_angles.h"

namespace ecorche::inline v1 {
namespace {

// Moments near a limit begin this far before it, at most so much of the range, and rise by the
// square: at the limit 2 * kLimitStiffness * kLimitMargin, 170 Nm.
constexpr double kLimitMargin = 5 * kDegree, kMarginOfRange = 0.15;
constexpr double kLimitStiffness = 1000;  // Nm/rad
constexpr double kTurn = 1e-5;            // rad, of finite differences

Quat turned(const Vec3& turn, const Quat& rotation) {
  const double angle = turn.norm();
  if (angle < 1e-14) return rotation;
  return (Quat(Eigen::AngleAxisd(angle, turn / angle)) * rotation).normalized();
}

// Moment against the approach to a limit, and its slope. x: how far inside the margin, rad.
void add_limit(double x, double margin, double sign, double& moment, double& slope) {
  if (x <= 0) return;
  moment -= sign * kLimitStiffness * x * (1 + x / margin);
  slope += kLimitStiffness * (1 + 2 * x / margin);
}

// Moments about the angles of a joint that turn, and their slopes.
void angle_moments(const Joint& joint, const Vec3& angles, const Vec3& rest, double stiffness,
                   const PassiveJoint& group, Vec3& moment, Vec3& slope) {
  moment.setZero();
  slope.setZero();
  for (int a = group.first_axis; a < group.first_axis + group.axes; ++a) {
    moment[a] = -stiffness * (angles[a] - rest[a]);
    slope[a] = stiffness;
    const double margin = std::min(kLimitMargin, kMarginOfRange * (joint.max[a] - joint.min[a]));
    add_limit(angles[a] - (joint.max[a] - margin), margin, 1, moment[a], slope[a]);
    add_limit(joint.min[a] + margin - angles[a], margin, -1, moment[a], slope[a]);
  }
}

// Change of a joint's angles by small turns about its axes, 3 x 3.
Mat3 angles_by_turns(const Joint& joint, const Quat& rotation, const Vec3& angles) {
  Mat3 out;
  for (int a = 0; a < 3; ++a) {
    const Quat moved = turned(kTurn * joint.axes.col(a), rotation);
    out.col(a) = (joint_angles(joint, moved) - angles) / kTurn;
  }
  return out;
}

using Jacobian3 = Eigen::Matrix<double, 3, Eigen::Dynamic>;

void find_columns(const ArticulatedModel& model, std::vector<JointColumn>& out) {
  out.assign(model.skeleton.joints.size(), {});
  int column = model.root_freedoms();
  for (std::size_t g = 0; g < model.groups.size(); ++g) {
    const PassiveJoint& group = model.groups[g];
    for (std::size_t k = 0; k < group.joints.size(); ++k)
      out[std::size_t(group.joints[k])] = {int(g), int(k), column};
    column += group.axes;
  }
}

bool is_driven(const ArticulatedModel& model, std::size_t j) {
  return !model.driven.empty() && model.driven[j];
}

// Velocities, and the accelerations that there are without any change of the freedoms'.
void find_motion(const ArticulatedModel& model, const BodyState& state, const BodyFrames& frames,
                 std::vector<JointMotion>& out) {
  out.assign(frames.X_WJ.size(), {});
  if (model.driven.empty()) {
    out[0].origin = state.velocity.head<3>();
    out[0].turn = state.velocity.segment<3>(3);
  }
  for (std::size_t j = 0; j < out.size(); ++j) {
    if (is_driven(model, j)) out[j] = state.driven[j];
    if (j == 0 || is_driven(model, j)) continue;
    const std::size_t p = std::size_t(model.skeleton.joints[j].parent);
    const JointMotion& above = out[p];
    Vec3 own = Vec3::Zero();
    const JointColumn& at = frames.columns[j];
    if (at.group >= 0) {
      const PassiveJoint& group = model.groups[std::size_t(at.group)];
      Vec3 turn = Vec3::Zero();
      for (int a = 0; a < group.axes; ++a)
        turn += group.shares[std::size_t(at.place)][group.first_axis + a] *
                state.velocity[at.column + a] *
                model.skeleton.joints[j].axes.col(group.first_axis + a);
      own = frames.X_WJ[p].linear() * turn;
    }
    const Vec3 r = frames.X_WJ[j].translation() - frames.X_WJ[p].translation();
    out[j].turn = above.turn + own;
    out[j].origin = above.origin + above.turn.cross(r);
    out[j].turn_rate = above.turn_rate + above.turn.cross(own);
    out[j].origin_rate =
        above.origin_rate + above.turn_rate.cross(r) + above.turn.cross(above.turn.cross(r));
  }
}

void add_passive_moments(const ArticulatedModel& model, const PassiveRest& rest, const Pose& pose,
                         BodyForces& out) {
  out.angles.clear();
  int column = model.root_freedoms();
  for (std::size_t g = 0; g < model.groups.size(); ++g) {
    const PassiveJoint& group = model.groups[g];
    const double joint_stiffness = group.stiffness * double(group.joints.size());
    for (std::size_t k = 0; k < group.joints.size(); ++k) {
      const Joint& joint = model.skeleton.joints[std::size_t(group.joints[k])];
      const Quat& rotation = pose.rotations[std::size_t(group.joints[k])];
      TurningAngles turning;
      turning.angles = joint_angles(joint, rotation);
      Vec3 moment, slope;
      angle_moments(joint, turning.angles, rest.angles[g][k], joint_stiffness, group, moment,
                    slope);
      const Mat3 G =
          angles_by_turns(joint, rotation, turning.angles) * group.shares[k].asDiagonal();
      turning.by_turns.leftCols(group.axes) = G.middleCols(group.first_axis, group.axes);
      const auto used = turning.by_turns.leftCols(group.axes);
      out.force.segment(column, group.axes).noalias() += used.transpose() * moment;
      const Mat3 pressed = turning.by_turns.transpose() * slope.asDiagonal() * turning.by_turns;
      out.stiffness.block(column, column, group.axes, group.axes) +=
          pressed.topLeftCorner(group.axes, group.axes);
      out.angles.push_back(turning);
    }
    for (int a = 0; a < group.axes; ++a) out.damping(column + a, column + a) += group.damping;
    column += group.axes;
  }
}

}  // namespace

double ArticulatedModel::mass() const {
  double sum = 0;
  for (const BodySegment& segment : segments) sum += segment.mass;
  return sum;
}

int ArticulatedModel::freedoms() const {
  int count = root_freedoms();
  for (const PassiveJoint& group : groups) count += group.axes;
  return count;
}

PassiveRest passive_rest(const ArticulatedModel& model, const Pose& pose) {
  PassiveRest out;
  for (const PassiveJoint& group : model.groups) {
    std::vector<Vec3> angles;
    for (const int j : group.joints)
      angles.push_back(
          joint_angles(model.skeleton.joints[std::size_t(j)], pose.rotations[std::size_t(j)]));
    out.angles.push_back(std::move(angles));
  }
  return out;
}

void body_frames(const ArticulatedModel& model, const Pose& pose, BodyFrames& out) {
  forward_kinematics(model.skeleton, pose, out.X_WJ);
  find_columns(model, out.columns);
  const int freedoms = model.freedoms();
  out.jacobian.resize(out.X_WJ.size());
  for (std::size_t j = 0; j < out.X_WJ.size(); ++j) {
    Eigen::MatrixXd& J = out.jacobian[j];
    J.setZero(6, freedoms);
    if (is_driven(model, j)) continue;
    if (j == 0) {
      J.block<3, 3>(0, 3).setIdentity();
      J.block<3, 3>(3, 0).setIdentity();
      continue;
    }
    const Joint& joint = model.skeleton.joints[j];
    const std::size_t p = std::size_t(joint.parent);
    const Vec3 r = out.X_WJ[j].translation() - out.X_WJ[p].translation();
    J = out.jacobian[p];
    J.bottomRows<3>().noalias() -= cross_matrix(r) * out.jacobian[p].topRows<3>();
    const JointColumn& at = out.columns[j];
    if (at.group < 0) continue;
    const PassiveJoint& group = model.groups[std::size_t(at.group)];
    const Vec3& share = group.shares[std::size_t(at.place)];
    for (int a = 0; a < group.axes; ++a)
      J.block<3, 1>(0, at.column + a) +=
          share[group.first_axis + a] *
          (out.X_WJ[p].linear() * joint.axes.col(group.first_axis + a));
  }
}

void body_forces(const ArticulatedModel& model, const PassiveRest& rest, const BodyState& state,
                 const BodyFrames& frames, double gravity, BodyForces& out) {
  const int n = model.freedoms();
  out.inertia.setZero(n, n);
  out.force.setZero(n);
  out.damping.setZero(n, n);
  out.stiffness.setZero(n, n);
  find_motion(model, state, frames, out.motion);
  Jacobian3 Jv(3, n), IJ(3, n);
  for (const BodySegment& segment : model.segments) {
    const std::size_t j = std::size_t(segment.joint);
    if (is_driven(model, j)) continue;
    const JointMotion& motion = out.motion[j];
    const Mat3 R = frames.X_WJ[j].linear();
    const Vec3 c = R * segment.center;
    const Mat3 I = R * segment.inertia * R.transpose();
    const auto Jw = frames.jacobian[j].topRows<3>();
    Jv = frames.jacobian[j].bottomRows<3>();
    Jv.noalias() -= cross_matrix(c) * Jw;
    IJ.noalias() = I * Jw;
    const Vec3& w = motion.turn;
    const Vec3 a = motion.origin_rate + motion.turn_rate.cross(c) + w.cross(w.cross(c)) +
                   gravity * Vec3::UnitY();
    out.inertia.noalias() += segment.mass * Jv.transpose() * Jv;
    out.inertia.noalias() += Jw.transpose() * IJ;
    const Vec3 push = segment.mass * a, moment = I * motion.turn_rate + w.cross(I * w);
    out.force.noalias() -= Jv.transpose() * push;
    out.force.noalias() -= Jw.transpose() * moment;
  }
  add_passive_moments(model, rest, state.pose, out);
}

void advance_body(const ArticulatedModel& model, double seconds, BodyState& state) {
  if (model.driven.empty()) {
    state.pose.root += seconds * state.velocity.head<3>();
    state.pose.rotations[0] =
        turned(seconds * state.velocity.segment<3>(3), state.pose.rotations[0]);
  }
  int column = model.root_freedoms();
  for (const PassiveJoint& group : model.groups) {
    for (std::size_t k = 0; k < group.joints.size(); ++k) {
      const std::size_t j = std::size_t(group.joints[k]);
      Vec3 turn = Vec3::Zero();
      for (int a = 0; a < group.axes; ++a)
        turn += seconds * group.shares[k][group.first_axis + a] * state.velocity[column + a] *
                model.skeleton.joints[j].axes.col(group.first_axis + a);
      state.pose.rotations[j] = turned(turn, state.pose.rotations[j]);
    }
    column += group.axes;
  }
  complete_pose(model.skeleton, state.pose);
}

double body_energy(const ArticulatedModel& model, const BodyState& state, const BodyFrames& frames,
                   double gravity) {
  double sum = 0;
  for (const BodySegment& segment : model.segments) {
    const std::size_t j = std::size_t(segment.joint);
    const Mat3 R = frames.X_WJ[j].linear();
    const Vec3 w = frames.jacobian[j].topRows<3>() * state.velocity;
    const Vec3 v =
        frames.jacobian[j].bottomRows<3>() * state.velocity + w.cross(Vec3(R * segment.center));
    const double height = (frames.X_WJ[j] * segment.center).y();
    sum += 0.5 * segment.mass * v.squaredNorm() +
           0.5 * w.dot(R * segment.inertia * R.transpose() * w) + segment.mass * gravity * height;
  }
  return sum;
}

double worst_limit_excess(const ArticulatedModel& model, const Pose& pose) {
  double worst = 0;
  for (const PassiveJoint& group : model.groups)
    for (const int j : group.joints)
      worst = std::max(worst, limit_excess(model.skeleton.joints[std::size_t(j)],
                                           pose.rotations[std::size_t(j)]));
  return worst;
}

}  // namespace ecorche::inline v1
