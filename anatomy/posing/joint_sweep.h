// One joint rotated through its range, one axis at a time: muscle paths and sections along the way,
// and their jumps.
#pragma once

#include <functional>
#include <vector>

#include "anatomy/posing/pose_anatomy.h"

namespace ecorche::inline v1 {

// Angles are anatomical (see Joint): rad from the anatomical zero, rising from the axis' lower
// limit to its upper one. The joint's other angles and all other joints stay as at rest; what
// depends on the joint (the patella) follows.
struct JointSweep {
  int joint = 0;
  int axis = 0;  // 0 flexion, 1 abduction, 2 rotation
  std::vector<double> angles;
};

// Every axis of every joint that turns by more than two steps, but the root. Throws
// std::invalid_argument if `step` (rad) is not positive and finite.
std::vector<JointSweep> joint_sweeps(const Skeleton& skeleton, double step);

// Preconditions: joint and axis exist. The rest pose for the rest pose's angle.
Pose swept_pose(const Skeleton& skeleton, int joint, int axis, double angle);

// Lengths of all strips along a sweep, m: #angles rows, #strips columns. `anatomy` is what the
// table was made of.
Eigen::MatrixXd swept_lengths(const PosingTable& table, const Skeleton& skeleton,
                              const JointSweep& sweep);

// Largest second difference |x0 - 2 x1 + x2| of a quantity over three successive angles: how far it
// is from a steady change.
struct SweepJump {
  double size = 0;  // m (length, centre, rim); share of the volume (drift)
  int joint = -1, axis = 0;
  double angle = 0;  // rad
};

// The worst of one strip over all sweeps.
struct StripSweep {
  SweepJump length;  // of the path
  SweepJump center;  // of a slice's centre
  SweepJump rim;     // of the ends of its axes
  SweepJump drift;   // of the strip's volume from rest
};

// Poses the muscles by themselves, or with stages that follow.
using PoseMuscles = std::function<void(const Pose& pose, PosedAnatomy& posed)>;

// One entry a strip.
std::vector<StripSweep> measure_sweeps(const PoseMuscles& pose_muscles, const Skeleton& skeleton,
                                       const std::vector<SliceRange>& ranges,
                                       const std::vector<JointSweep>& sweeps);

// The same by pose_anatomy(); `threads` as there.
std::vector<StripSweep> measure_sweeps(const PosingTable& table, const Skeleton& skeleton,
                                       const std::vector<SliceRange>& ranges,
                                       const std::vector<JointSweep>& sweeps, int threads = 1);

}  // namespace ecorche::inline v1
