// Forward dynamics of a body of rigid segments in reduced coordinates (Featherstone, Rigid Body
// Dynamics Algorithms, 2008): inertia by composite segments, velocity products by a pass from the
// root.
//
// Velocities: of the root joint, world, m/s; turn of the root, world, rad/s; then of each group
// about its axes, rad/s. Where the root is driven those of the groups alone. A joint's turn is
// counted in its parent's axes, so that no pose is singular.
#pragma once

#include <vector>

#include "anatomy/body_segment.h"
#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// Joints that turn together: one of a limb, or all of the spine. Its velocities are turns about the
// axes of Joint::axes, of which each joint takes its share.
struct PassiveJoint {
  std::vector<int> joints;
  std::vector<Vec3> shares;  // #joints, by axis; sum 1
  int axes = 3;              // how many of Joint::axes
  double stiffness = 0;      // towards PassiveRest, Nm/rad
  double damping = 0;        // Nm s/rad
  int first_axis = 0;        // 0 flexion, 1 abduction, 2 rotation
};

struct ArticulatedModel {
  Skeleton skeleton;
  std::vector<BodySegment> segments;
  std::vector<PassiveJoint> groups;
  // #joints: whose motion is given from outside; empty: none, and the root is free
  std::vector<char> driven;

  double mass() const;
  int root_freedoms() const { return driven.empty() ? 6 : 0; }
  int freedoms() const;  // of the root, and those of the groups
};

// Velocity and acceleration of a joint's frame, world.
struct JointMotion {
  Vec3 turn = Vec3::Zero(), origin = Vec3::Zero();            // rad/s, m/s
  Vec3 turn_rate = Vec3::Zero(), origin_rate = Vec3::Zero();  // rad/s^2, m/s^2
};

struct BodyState {
  Pose pose;
  Eigen::VectorXd velocity;         // #freedoms
  std::vector<JointMotion> driven;  // #joints: of those that are driven; empty where none is
};

struct JointColumn {
  int group = -1, place = -1;  // of the group's joints
  int column = -1;             // of its first velocity
};

// Frames and velocities of all joints.
struct BodyFrames {
  std::vector<Transform> X_WJ;  // #joints
  // 6 x #freedoms a joint: its turn above, the velocity of its origin below; world
  std::vector<Eigen::MatrixXd> jacobian;
  std::vector<JointColumn> columns;  // #joints
};

// Angles of a joint of a group, and their change by the group's velocities, a column an axis.
struct TurningAngles {
  Vec3 angles = Vec3::Zero();
  Mat3 by_turns = Mat3::Zero();
};

// Forces of one step, linear in the velocities at its end.
struct BodyForces {
  Eigen::MatrixXd inertia;            // #freedoms square, kg, kg m, kg m^2
  Eigen::VectorXd force;              // without damping: weight, velocity products, passive moments
  Eigen::MatrixXd damping;            // of the passive joints
  Eigen::MatrixXd stiffness;          // likewise, positive semi-definite
  std::vector<JointMotion> motion;    // #joints, rates as they are without change of velocities
  std::vector<TurningAngles> angles;  // of the joints of the groups, group after group
};

struct PassiveRest {
  std::vector<std::vector<Vec3>> angles;  // #groups, #joints of the group; rad
};

// Angles that passive stiffness pulls back to.
PassiveRest passive_rest(const ArticulatedModel& model, const Pose& pose);

void body_frames(const ArticulatedModel& model, const Pose& pose, BodyFrames& out);

// `gravity`: m/s^2, downwards along -Y.
void body_forces(const ArticulatedModel& model, const PassiveRest& rest, const BodyState& state,
                 const BodyFrames& frames, double gravity, BodyForces& out);

// Moves the pose on by the state's velocities; driven joints stay.
void advance_body(const ArticulatedModel& model, double seconds, BodyState& state);

// Kinetic and potential energy, J; of the passive moments none. For a free root.
double body_energy(const ArticulatedModel& model, const BodyState& state, const BodyFrames& frames,
                   double gravity);

// How far the worst angle of the groups' joints is beyond its limits, rad.
double worst_limit_excess(const ArticulatedModel& model, const Pose& pose);

}  // namespace ecorche::inline v1
