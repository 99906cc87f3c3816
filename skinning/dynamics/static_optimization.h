// How hard muscles work, read off a motion: the moments that gravity and acceleration ask of the
// joints, shared out among the muscles.
//
// A default, not a measurement. Segments are points of mass (center_of_mass.h) that turn about the
// joints without inertia of their own; the ground's force carries the whole body's weight and
// acceleration, at the points of the feet that are low and slow, the nearer to the point that asks
// for no moment the more. Joints whose turn carries no segment (fingers, toes, jaw) stay relaxed,
// and of the spine five levels stand for all. Moment arms are differences of the path lengths; a
// muscle can pull 30 N/cm^2 of its section. The shares make the least sum of squares of activation
// that gives the moments (Crowninshield & Brand 1981, 10.1016/0021-9290(81)90035-X), a spring
// taking what is too much.
#pragma once

#include "anatomy/posing/pose_anatomy.h"
#include "skinning/motion/activation.h"

namespace ecorche {

struct AutoActivationReport {
  int samples = 0;               // of the motion, 20 a second
  double reserve_share = 0;      // of the moments that the muscles do not give, mean over samples
  double ground_force_peak = 0;  // over the body's weight
};

// One curve a muscle that works at all. Preconditions (std::invalid_argument): the table is the
// anatomy's, the skeleton has our joints, the motion has frames. A mass of 0 counts as 70 kg. The
// same bytes at any number of threads.
Activations auto_activations(const PosingTable& table, const Anatomy& anatomy, const Body& body,
                             const Motion& motion, AutoActivationReport& report);

// min |a|^2 / 2 + stiffness |A a - b|^2 / 2 for a in [0, 1], by Newton on the dual. A: #moments x
// #muscles. For tests and for auto_activations.
Eigen::VectorXd share_moments(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double stiffness);

}  // namespace ecorche
