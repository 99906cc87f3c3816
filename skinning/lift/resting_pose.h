// Poses that people are laid down and seated in.
#pragma once

#include "skinning/lift/patient.h"

namespace ecorche::inline v1 {

// Supine, face up (+Y), head towards -Z, hands on the belly, the lowest vertex of the skin at
// height 0. A skeleton without our joints only turns.
Pose lying_pose(const Patient& patient);

// Knees bent and a little higher than level thighs have them, as on a seat 3 cm lower than the
// hollow of the knee; forwards towards +Z, hands on the belly, likewise. `recline`: of the
// trunk backwards, degrees.
Pose sitting_pose(const Patient& patient, double recline = 0);

}  // namespace ecorche::inline v1
