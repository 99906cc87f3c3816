// An upper arm set against the thorax, with the shoulder girdle where the rhythm has it.
#pragma once

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// rad. From hanging with the palm to the thigh.
struct ArmDirection {
  double elevation = 0;  // 0 hanging, pi straight up
  double plane = 0;      // of elevation: 0 to the side, pi/2 forwards
  double outwards = 0;   // rotation about the arm's own axis
};

// Sets clavicle, scapula and shoulder of a side (shoulder_rhythm.h). Precondition: the skeleton has
// these and the elbow.
void raise_arm(const Skeleton& skeleton, Side side, const ArmDirection& direction, Pose& pose);

// Whether the skeleton has the joints that raise_arm() needs.
bool has_arm(const Skeleton& skeleton, Side side);

}  // namespace ecorche::inline v1
