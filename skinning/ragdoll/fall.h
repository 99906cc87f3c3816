// A body that is let go: it falls on the ground, comes to rest and lies there.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "skinning/ragdoll/ragdoll_step.h"

namespace ecorche::inline v1 {

struct FallOptions {
  double tone = 0;           // of the muscles, 0 limp .. 1 tense
  Vec3 push = Vec3::Zero();  // m/s that a shove at the middle of the chest gives it, world
  double seconds = 3;
  double fps = 60;                  // of the motion
  double longest_step = 1.0 / 600;  // s; a frame has a whole number of steps
  bool frictionless = false;        // joints without resistance or limits; `tone` is nothing then
  RagdollOptions world;             // its step is set
};

struct FallResult {
  Motion motion;                 // its first frame is the pose that was let go
  double weight = 0;             // N
  double peak_force = 0;         // N upwards, of the ground, mean of a frame
  double end_force = 0;          // N, mean of the last quarter of a second
  double touch = -1;             // s, when the ground first bears something; -1: never
  double rest = -1;              // s, from which on no joint moves faster than 1 cm/s
  double end_speed = 0;          // m/s, of the fastest joint in the last quarter of a second
  double limit_excess = 0;       // rad, of any joint that turns at any frame
  std::string worst_joint;       // that goes so far
  double deepest = 0;            // m, of any point of the skin below the ground
  double overlap = 0;            // m, of limbs, beyond what tissue yields
  std::vector<double> energies;  // J, kinetic and potential, a frame
};

// From a pose, and velocities of it (BodyState::velocity; empty: at rest).
FallResult fall(Ragdoll ragdoll, BodyState start, const FallOptions& options,
                const std::function<void(double)>& progress = {});

// Raises or lowers the pose: the skin's lowest point at this height.
void put_at_height(const Ragdoll& ragdoll, double height, Pose& pose);

}  // namespace ecorche::inline v1
