// Muscle activations of a motion from itself: its forces by inverse dynamics (inverse_dynamics.h),
// shared out by static optimization (static_optimization.h).
#pragma once

#include <span>

#include "skinning/binding.h"
#include "skinning/dynamics/static_optimization.h"

namespace ecorche::inline v1 {

struct AutoActivations {
  Activations activations;
  MuscleEfforts efforts;
  double ground_force_peak = 0;  // over the body's weight
  double residual_force = 0;     // root mean square over the weight
  bool table_masses = false;     // the skin has no inside: masses are a table's, of points
};

// A motion of one or two frames is a posture that is held. A mass of 0 counts as 70 kg. `weights`:
// #V of body.skin. Preconditions (std::invalid_argument): the table is the anatomy's, whose
// skeleton has our joints; the motion has frames.
AutoActivations auto_activations(const PosingTable& table, const Anatomy& anatomy, const Body& body,
                                 std::span<const JointWeights> weights, const Motion& motion);

}  // namespace ecorche::inline v1
