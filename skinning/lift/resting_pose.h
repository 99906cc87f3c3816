// Poses that people are laid down and seated in.
#pragma once

#include "skinning/lift/patient.h"

namespace ecorche::inline v1 {

// Supine, face up (+Y), head towards -Z, hands on the belly, the lowest vertex of the skin at
// height 0. A skeleton without our joints only turns.
Pose lying_pose(const Patient& patient);

// Upright, hips and knees bent, forwards towards +Z, hands on the belly, likewise.
Pose sitting_pose(const Patient& patient);

}  // namespace ecorche::inline v1
