// A motion with its first and second derivatives.
#pragma once

#include <vector>

#include "skinning/dynamics/joint_loads.h"

namespace ecorche::inline v1 {

// Passes each column twice, forth and back, through a second-order Butterworth low-pass, so that
// nothing lags; `cutoff` (Hz) is where the two passes together have halved the power (Winter 2009,
// section 2.2.4.4). Ends are continued point-symmetrically. Columns stay as they are where the
// cut-off is not below 0.45 of `fps`, or 0.
void low_pass(double fps, double cutoff, Eigen::MatrixXd& columns);

// The smoothed motion, a state a frame; derivatives are central differences. The first and the last
// frame have the accelerations of their neighbours. Preconditions: frames, fps above 0.
std::vector<MotionState> smooth_motion(const Motion& motion, double cutoff);

}  // namespace ecorche::inline v1
