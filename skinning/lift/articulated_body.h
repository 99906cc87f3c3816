// Forward dynamics of a patient in reduced coordinates (Featherstone, Rigid Body Dynamics
// Algorithms, 2008): inertia by composite segments, velocity products by a pass from the root.
//
// Velocities: of the root joint, world, m/s; turn of the root, world, rad/s; then of each group
// about its axes, rad/s. A joint's turn is counted in its parent's axes, so that no pose is
// singular.
#pragma once

#include <vector>

#include "skinning/lift/patient.h"

namespace ecorche::inline v1 {

struct BodyState {
  Pose pose;
  Eigen::VectorXd velocity;  // #freedoms
};

// Frames and velocities of all joints.
struct BodyFrames {
  std::vector<Transform> X_WJ;  // #joints
  // 6 x #freedoms a joint: its turn above, the velocity of its origin below; world
  std::vector<Eigen::MatrixXd> jacobian;
};

// Forces of one step, linear in the velocities at its end.
struct BodyForces {
  Eigen::MatrixXd inertia;    // #freedoms square, kg, kg m, kg m^2
  Eigen::VectorXd force;      // without damping: weight, velocity products, passive moments
  Eigen::MatrixXd damping;    // of the passive joints
  Eigen::MatrixXd stiffness;  // likewise, positive semi-definite
};

struct PassiveRest {
  std::vector<std::vector<Vec3>> angles;  // #groups, #joints of the group; rad
};

// Angles that passive stiffness pulls back to.
PassiveRest passive_rest(const Patient& patient, const Pose& pose);

void body_frames(const Patient& patient, const Pose& pose, BodyFrames& out);

// `gravity`: m/s^2, downwards along -Y.
void body_forces(const Patient& patient, const PassiveRest& rest, const BodyState& state,
                 const BodyFrames& frames, double gravity, BodyForces& out);

// Moves the pose on by the state's velocities.
void advance_body(const Patient& patient, double seconds, BodyState& state);

// Kinetic and potential energy, J; of the passive moments none.
double body_energy(const Patient& patient, const BodyState& state, const BodyFrames& frames,
                   double gravity);

// How far the worst angle of the groups' joints is beyond its limits, rad.
double worst_limit_excess(const Patient& patient, const Pose& pose);

}  // namespace ecorche::inline v1
