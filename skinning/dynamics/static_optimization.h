// Muscle activations of a motion by static optimization: the joint moments of inverse dynamics,
// shared out among the muscles.
//
// Every strip of every muscle pulls by itself, as hard as its fibre's length and speed and its
// tendon let it (strip_forces.h), at the moment arms that its line has in the pose
// (posing/moment_arms.h). Efforts have the least sum of squares, each strip counting by its share
// of its muscle (Crowninshield & Brand 1981, 10.1016/0021-9290(81)90035-X); a reserve takes what is
// beyond the muscles. Fibres are long and fast as the tendon under the force of the solution before
// leaves them. Muscles do not switch: activations are means of three neighbours.
//
// Joints that carry no segment (fingers, toes, jaw) stay relaxed, knees are hinges whose other
// moments ligaments take, and five levels of the spine stand for all.
#pragma once

#include <string>
#include <vector>

#include "anatomy/posing/posing_table.h"
#include "skinning/dynamics/inverse_dynamics.h"
#include "skinning/motion/activation.h"

namespace ecorche::inline v1 {

// A moment that muscles have to give, about an axis of a joint.
struct MuscleMoment {
  std::string name;  // "knee_l_flexion"
  int joint = 0;
  std::vector<double> wanted;   // #samples, N m
  std::vector<double> reserve;  // #samples, N m, of it what muscles do not give
};

struct MuscleEfforts {
  std::vector<double> times;    // #samples, s from the first frame; at most 60 a second
  Eigen::MatrixXd activations;  // #muscles x #samples, 0..1
  std::vector<MuscleMoment> moments;
  double reserve_share = 0;  // of the moments over the muscles' capacity, mean over samples
};

// Preconditions (std::invalid_argument): the table is the anatomy's, whose skeleton has our joints;
// the dynamics are of that skeleton. Samples run in parallel; the same bytes at any number of
// threads.
MuscleEfforts static_optimization(const PosingTable& table, const Anatomy& anatomy,
                                  const MotionDynamics& dynamics);

// One curve for each muscle that is ever active.
Activations activations_of(const MuscleEfforts& efforts);

// Root mean squares over time of all axes of a joint, N m.
struct JointReserve {
  int joint = 0;
  double wanted = 0, reserve = 0;
};
std::vector<JointReserve> joint_reserves(const MuscleEfforts& efforts);

}  // namespace ecorche::inline v1
