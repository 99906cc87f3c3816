// Estimated ground reaction beside a measured one.
#pragma once

#include <array>
#include <vector>

#include "skinning/dynamics/inverse_dynamics.h"

namespace ecorche::inline v1 {

// Of one foot, or of both together. Forces are over the body's weight.
struct GroundDifference {
  double vertical_rms = 0, forward_rms = 0, sideways_rms = 0;
  double correlation = 0;  // of the vertical force
  double peak = 0, measured_peak = 0;
};

struct GroundComparison {
  GroundDifference both;
  std::array<GroundDifference, 2> feet;  // left, right
  double measured_mean = 0;  // vertical, both feet: 1 where the body has the weight of the person
  // Times of landings and take-offs, estimated after measured, s: mean and mean distance.
  double landing = 0, landing_off = 0, leaving = 0, leaving_off = 0;
  int contacts = 0;  // that both have
  // Steps that miss the plates; and the part of the frames in which each foot, and both, are
  // compared.
  int beside = 0;
  std::array<double, 3> compared{};  // left, right, both
};

// A foot that bears the body while plates measure nothing under it stands beside them: it is left
// out for that step, and the sum of both feet with it.
//
// measured: #frames. Forwards and sideways are those of the pelvis. The first and last 0.05 s are
// left out, as in the figures of MotionDynamics.
GroundComparison compare_ground(const MotionDynamics& dynamics,
                                const std::vector<std::array<FootForce, 2>>& measured);

}  // namespace ecorche::inline v1
