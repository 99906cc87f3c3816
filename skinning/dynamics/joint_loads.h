// Forces and moments in the joints of a moving body, by the recursive Newton-Euler algorithm
// (Featherstone 2008, Rigid Body Dynamics Algorithms, chapter 5) on joints of three turns each.
#pragma once

#include <span>
#include <vector>

#include "anatomy/body_segment.h"
#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

inline constexpr double kGravity = 9.81;  // m/s^2

// A pose and how it changes. Turns of a joint are those of its frame in its parent's, in axes of
// the parent's frame; of the root in the world's.
struct MotionState {
  Pose pose;
  Vec3 root_velocity = Vec3::Zero(), root_acceleration = Vec3::Zero();  // world
  std::vector<Vec3> rates;                                              // #joints, rad/s
  std::vector<Vec3> turn_accelerations;                                 // #joints, rad/s^2
};

// A force from outside at a place of the body that a joint carries.
struct ExternalForce {
  int joint = 0;
  Vec3 place = Vec3::Zero(), force = Vec3::Zero(), moment = Vec3::Zero();  // world
};

// What a joint has to give to all that lies beyond it, about the joint's centre, world. At the
// root: what is still missing from outside.
struct JointLoad {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();  // N, N m
};

// Of the whole body, world.
struct BodyMomentum {
  Vec3 center = Vec3::Zero(), velocity = Vec3::Zero();  // of mass
  Vec3 angular = Vec3::Zero();                          // about the centre of mass, kg m^2/s
  double mass = 0, kinetic_energy = 0;                  // kg, J
};

struct BodyLoads {
  std::vector<Transform> X_WJ;    // #joints
  std::vector<JointLoad> joints;  // #joints
  std::vector<double> power;      // #joints, W: the moment's on the joint's turn; root 0
  BodyMomentum momentum;
};

// `out` is resized once and then reused. Preconditions: rates and accelerations a joint; joints of
// segments and forces in range.
void find_joint_loads(const Skeleton& skeleton, std::span<const BodySegment> segments,
                      const MotionState& state, std::span<const ExternalForce> forces,
                      BodyLoads& out);

}  // namespace ecorche::inline v1
