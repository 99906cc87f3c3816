#include "skinning/lift/articulated_body.h"

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

// Moments about the three angles of a joint, and their slopes.
void angle_moments(const Joint& joint, const Vec3& angles, const Vec3& rest, double stiffness,
                   int axes, Vec3& moment, Vec3& slope) {
  moment.setZero();
  slope.setZero();
  for (int a = 0; a < axes; ++a) {
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

struct JointTurns {
  int group = -1, place = -1;  // of the group's joints
  int column = -1;             // of its first velocity
};

std::vector<JointTurns> turns_of_joints(const Patient& patient) {
  std::vector<JointTurns> out(patient.skeleton.joints.size());
  int column = 6;
  for (std::size_t g = 0; g < patient.groups.size(); ++g) {
    const PassiveJoint& group = patient.groups[g];
    for (std::size_t k = 0; k < group.joints.size(); ++k)
      out[std::size_t(group.joints[k])] = {int(g), int(k), column};
    column += group.axes;
  }
  return out;
}

// Accelerations that there are without any change of the velocities: turn, origin. #joints
struct Acceleration {
  Vec3 turn = Vec3::Zero(), origin = Vec3::Zero();
};

std::vector<Acceleration> velocity_products(const Patient& patient, const BodyState& state,
                                            const BodyFrames& frames) {
  std::vector<Acceleration> out(frames.X_WJ.size());
  for (std::size_t j = 1; j < out.size(); ++j) {
    const std::size_t p = std::size_t(patient.skeleton.joints[j].parent);
    const Vec3 w = frames.jacobian[p].topRows<3>() * state.velocity;
    const Vec3 own = frames.jacobian[j].topRows<3>() * state.velocity - w;
    const Vec3 r = frames.X_WJ[j].translation() - frames.X_WJ[p].translation();
    out[j].turn = out[p].turn + w.cross(own);
    out[j].origin = out[p].origin + out[p].turn.cross(r) + w.cross(w.cross(r));
  }
  return out;
}

void add_passive_moments(const Patient& patient, const PassiveRest& rest, const Pose& pose,
                         BodyForces& out) {
  int column = 6;
  for (std::size_t g = 0; g < patient.groups.size(); ++g) {
    const PassiveJoint& group = patient.groups[g];
    const double joint_stiffness = group.stiffness * double(group.joints.size());
    for (std::size_t k = 0; k < group.joints.size(); ++k) {
      const Joint& joint = patient.skeleton.joints[std::size_t(group.joints[k])];
      const Quat& rotation = pose.rotations[std::size_t(group.joints[k])];
      const Vec3 angles = joint_angles(joint, rotation);
      Vec3 moment, slope;
      angle_moments(joint, angles, rest.angles[g][k], joint_stiffness, group.axes, moment, slope);
      const Mat3 G = angles_by_turns(joint, rotation, angles) * group.shares[k].asDiagonal();
      const Eigen::MatrixXd used = G.leftCols(group.axes);
      out.force.segment(column, group.axes) += used.transpose() * moment;
      out.stiffness.block(column, column, group.axes, group.axes) +=
          used.transpose() * slope.asDiagonal() * used;
    }
    for (int a = 0; a < group.axes; ++a) out.damping(column + a, column + a) += group.damping;
    column += group.axes;
  }
}

}  // namespace

PassiveRest passive_rest(const Patient& patient, const Pose& pose) {
  PassiveRest out;
  for (const PassiveJoint& group : patient.groups) {
    std::vector<Vec3> angles;
    for (const int j : group.joints)
      angles.push_back(
          joint_angles(patient.skeleton.joints[std::size_t(j)], pose.rotations[std::size_t(j)]));
    out.angles.push_back(std::move(angles));
  }
  return out;
}

void body_frames(const Patient& patient, const Pose& pose, BodyFrames& out) {
  forward_kinematics(patient.skeleton, pose, out.X_WJ);
  const std::vector<JointTurns> turns = turns_of_joints(patient);
  const int freedoms = patient.freedoms();
  out.jacobian.resize(out.X_WJ.size());
  for (std::size_t j = 0; j < out.X_WJ.size(); ++j) {
    Eigen::MatrixXd& J = out.jacobian[j];
    J.setZero(6, freedoms);
    if (j == 0) {
      J.block<3, 3>(0, 3).setIdentity();
      J.block<3, 3>(3, 0).setIdentity();
      continue;
    }
    const Joint& joint = patient.skeleton.joints[j];
    const std::size_t p = std::size_t(joint.parent);
    const Vec3 r = out.X_WJ[j].translation() - out.X_WJ[p].translation();
    J.topRows<3>() = out.jacobian[p].topRows<3>();
    J.bottomRows<3>() = out.jacobian[p].bottomRows<3>() - cross_matrix(r) * J.topRows<3>();
    if (turns[j].group < 0) continue;
    const PassiveJoint& group = patient.groups[std::size_t(turns[j].group)];
    const Vec3& share = group.shares[std::size_t(turns[j].place)];
    for (int a = 0; a < group.axes; ++a)
      J.block<3, 1>(0, turns[j].column + a) +=
          share[a] * (out.X_WJ[p].linear() * joint.axes.col(a));
  }
}

void body_forces(const Patient& patient, const PassiveRest& rest, const BodyState& state,
                 const BodyFrames& frames, double gravity, BodyForces& out) {
  const int n = patient.freedoms();
  out.inertia.setZero(n, n);
  out.force.setZero(n);
  out.damping.setZero(n, n);
  out.stiffness.setZero(n, n);
  const std::vector<Acceleration> products = velocity_products(patient, state, frames);
  for (const BodySegment& segment : patient.segments) {
    const std::size_t j = std::size_t(segment.joint);
    const Mat3 R = frames.X_WJ[j].linear();
    const Vec3 c = R * segment.center;
    const Mat3 I = R * segment.inertia * R.transpose();
    const Eigen::Matrix<double, 3, Eigen::Dynamic> Jw = frames.jacobian[j].topRows<3>();
    const Eigen::Matrix<double, 3, Eigen::Dynamic> Jv =
        frames.jacobian[j].bottomRows<3>() - cross_matrix(c) * Jw;
    const Vec3 w = Jw * state.velocity;
    const Vec3 a = products[j].origin + products[j].turn.cross(c) + w.cross(w.cross(c)) +
                   gravity * Vec3::UnitY();
    out.inertia.noalias() += segment.mass * Jv.transpose() * Jv + Jw.transpose() * I * Jw;
    out.force.noalias() -= segment.mass * Jv.transpose() * a +
                           Jw.transpose() * (I * products[j].turn + w.cross(I * w));
  }
  add_passive_moments(patient, rest, state.pose, out);
}

void advance_body(const Patient& patient, double seconds, BodyState& state) {
  state.pose.root += seconds * state.velocity.head<3>();
  state.pose.rotations[0] = turned(seconds * state.velocity.segment<3>(3), state.pose.rotations[0]);
  int column = 6;
  for (const PassiveJoint& group : patient.groups) {
    for (std::size_t k = 0; k < group.joints.size(); ++k) {
      const std::size_t j = std::size_t(group.joints[k]);
      Vec3 turn = Vec3::Zero();
      for (int a = 0; a < group.axes; ++a)
        turn += seconds * group.shares[k][a] * state.velocity[column + a] *
                patient.skeleton.joints[j].axes.col(a);
      state.pose.rotations[j] = turned(turn, state.pose.rotations[j]);
    }
    column += group.axes;
  }
  complete_pose(patient.skeleton, state.pose);
}

double body_energy(const Patient& patient, const BodyState& state, const BodyFrames& frames,
                   double gravity) {
  double sum = 0;
  for (const BodySegment& segment : patient.segments) {
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

double worst_limit_excess(const Patient& patient, const Pose& pose) {
  double worst = 0;
  for (const PassiveJoint& group : patient.groups)
    for (const int j : group.joints)
      worst = std::max(worst, limit_excess(patient.skeleton.joints[std::size_t(j)],
                                           pose.rotations[std::size_t(j)]));
  return worst;
}

}  // namespace ecorche::inline v1
