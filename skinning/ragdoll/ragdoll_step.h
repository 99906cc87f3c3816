// One step of a ragdoll: velocities halfway between poses (leapfrog, after Verlet 1967,
// 10.1103/PhysRev.159.98), with damping and springs of the joints at the step's end, contacts with
// the ground, limbs that meet, and limits in one convex problem of velocities. The first step
// pushes for half its time, so that it begins with the pose's own velocities; forces that depend on
// velocities see those of the pose, as the step before lets expect them. A step in which skin
// strikes the ground is made in several parts.
//
// A contact or limit that is not reached yet lets through what way is left, so that nothing passes
// within a step; what is beyond goes back by a share a step (Baumgarte 1972,
// 10.1016/0045-7825(72)90018-7).
#pragma once

#include <vector>

#include "skinning/multibody/cone_solver.h"
#include "skinning/ragdoll/ragdoll.h"

namespace ecorche::inline v1 {

struct RagdollOptions {
  double step = 1.0 / 600;  // s
  double gravity = 9.81;    // m/s^2
  bool ground = true;
  double ground_height = 0;  // world, m
  double friction = 0.5;     // of clothes on a floor
  // m that skin is pressed in before the ground holds it: what lies rests on broad places
  double flesh = 0.006;
};

struct RagdollState {
  BodyState body;        // velocities: of half a step before the pose, once a step was made
  double last_step = 0;  // s, of the step before
  // Of velocities, in the step before; 0 where something met, empty before the first one.
  Eigen::VectorXd acceleration;
  PassiveRest rest;
  double time = 0;                   // s
  Vec3 ground_force = Vec3::Zero();  // N, of the last step
  // Frames of the pose that the last step began with, and workspace.
  BodyFrames frames;
  BodyForces forces;
  ConeSolver solver;
  std::vector<ProxyContact> meeting;
  std::vector<JointMotion> carried;  // joints of driven ones, without own velocities
  Eigen::MatrixXd system;
  Eigen::VectorXd pushed;
  std::vector<int> grounded;  // columns of the ground's contacts
};

void step_ragdoll(const Ragdoll& ragdoll, const RagdollOptions& options, RagdollState& state);

// Velocities of the pose, from those of half a step before.
Eigen::VectorXd pose_velocity(const RagdollState& state);

// World height of the lowest point of the skin.
double lowest_point(const Ragdoll& ragdoll, const std::vector<Transform>& X_WJ);

}  // namespace ecorche::inline v1
