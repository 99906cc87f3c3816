// Frames in which constraints are worked out: contacts, their fading, snaps and what is averaged
// over time must not depend on how often a recording was looked at.
#pragma once

#include <array>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/foot_contacts.h"
#include "skinning/constraints/joint_limits.h"

namespace ecorche::inline v1 {

// Brings a motion to some 120 frames a second, where it has fewer, by a whole number of frames for
// each of its own, on smooth curves through these (sample_motion.h); shifts go straight from one to
// the next. Precondition: as many places of heels and balls as frames, and as many shifts or none.
void refine_frames(Motion& motion, std::array<FootPaths, 2>& feet, std::vector<LimbShifts>& shifts);

}  // namespace ecorche::inline v1
