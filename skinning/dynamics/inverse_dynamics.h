// Forces behind a motion: the ground's on the feet, moments and power of joints, and what is left
// over.
//
// The motion is smoothed without lag (smooth_motion.h), its centre of mass brought to a path that
// the contacts can give (supported_path.h), the loads of joints follow by recursive
// Newton-Euler (joint_loads.h), and what the root misses is taken from the ground as far as soles
// stand (ground_reaction.h). The rest is the residual: a body in the air has to have none, on the
// ground less than 5 % of the largest force, and of the moment less than 1 % of that times the
// height of the centre of mass (Hicks et al. 2015, 10.1115/1.4029304).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "skinning/dynamics/ground_reaction.h"
#include "skinning/dynamics/joint_loads.h"

namespace ecorche::inline v1 {

// Hz. Walking has next to nothing above 6 Hz (Winter 2009); impacts of running and jumping have.
inline constexpr double kWalkingCutoff = 6, kFlyingCutoff = 12;

struct DynamicsOptions {
  // Hz; below 0: kWalkingCutoff, or kFlyingCutoff for a motion that leaves the ground for 80 ms;
  // 0: the motion as it is
  double cutoff = -1;
  bool ground = true;  // false: nothing outside holds the body
  // What plates measured under the left and right foot, #frames; joints take these forces in place
  // of the estimated ones. Empty: none.
  std::vector<std::array<FootForce, 2>> measured{};
};

struct DynamicsFrame {
  BodyLoads loads;
  std::array<FootForce, 2> feet;        // left, right: that joints and residual are with
  std::array<FootForce, 2> estimated;   // the same without plates
  Vec3 residual_force = Vec3::Zero();   // N, world
  Vec3 residual_moment = Vec3::Zero();  // N m, about the centre of mass
  double contact = 0;                   // sum of the points' gates
};

struct MotionDynamics {
  double fps = 0, cutoff = 0, weight = 0;  // Hz, Hz, N
  double center_height = 0;                // m over the floor, mean
  Vec3 belt = Vec3::Zero();                // m/s, of a treadmill under the feet; nought: a floor
  double center_moved = 0;                 // m, furthest, to its support (supported_path.h)
  std::vector<MotionState> states;         // #frames, smoothed
  std::vector<DynamicsFrame> frames;       // #frames
  // Figures over the frames but the first and last 0.05 s, which have no derivatives of their own.
  double peak_vertical = 0, mean_vertical = 0;             // of both feet, over the weight
  double residual_force_rms = 0, residual_force_peak = 0;  // over the weight
  double residual_moment_rms = 0;  // over weight and height of the centre of mass
  double flight_residual_rms = 0;  // force in frames without contact, over the weight
  int flight_frames = 0;           // without contact
};

// sole_height: world y of the soles at rest. Frames run in parallel; the same bytes at any number
// of threads. Preconditions (std::invalid_argument): the skeleton has our joints, the motion has
// three frames or more and as many
// measured ones or none, segments have mass.
MotionDynamics inverse_dynamics(const Skeleton& skeleton, std::span<const BodySegment> segments,
                                double sole_height, const Motion& motion,
                                const DynamicsOptions& options = {});

}  // namespace ecorche::inline v1
