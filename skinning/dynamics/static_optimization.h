// Muscle activations of a motion by static optimization: the joint moments that gravity and
// acceleration require, distributed among the muscles.
//
// A default, not a measurement. Segments are point masses (center_of_mass.h) without inertia of
// their own; the ground reaction carries the whole body's weight and acceleration, at the points of
// the feet that are low and slow, and mostly at those where it needs no moment. Joints that carry
// no segment (fingers, toes, jaw) stay relaxed, and five levels of the spine stand for all. Moment
// arms are differences of path lengths; a muscle's largest force is 30 N/cm^2 of its section.
// Activations have the least sum of squares that gives the moments (Crowninshield & Brand
// 1981, 10.1016/0021-9290(81)90035-X); a reserve spring takes the excess.
#pragma once

#include "anatomy/posing/pose_anatomy.h"
#include "skinning/motion/activation.h"

namespace ecorche::inline v1 {

struct AutoActivationReport {
  int samples = 0;               // of the motion, 20 a second
  double reserve_share = 0;      // fraction of the moments beyond the muscles, mean over samples
  double ground_force_peak = 0;  // over the body's weight
};

// One curve for each muscle that is ever active. Preconditions (std::invalid_argument): the table
// is the anatomy's, the skeleton has our joints, the motion has frames. A mass of 0 counts as 70
// kg. The same bytes at any number of threads.
Activations auto_activations(const PosingTable& table, const Anatomy& anatomy, const Body& body,
                             const Motion& motion, AutoActivationReport& report);

// min |a|^2 / 2 + stiffness |A a - b|^2 / 2 for a in [0, 1], by Newton on the dual. A: #moments x
// #muscles. For tests and for auto_activations.
Eigen::VectorXd distribute_moments(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                   double stiffness);

}  // namespace ecorche::inline v1
