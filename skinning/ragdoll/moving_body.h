// How fast a body moves in a motion.
#pragma once

#include "skinning/multibody/articulated_body.h"

namespace ecorche::inline v1 {

// Pose and velocities at a time, s from the first frame, as far as the model's freedoms have them.
BodyState moving_body(const ArticulatedModel& body, const Motion& motion, double time);

// Velocities and accelerations of frames, from those a step before and a step after. Rates are
// such that the next step has the velocities from now to `after`.
JointMotion frame_motion(const Transform& before, const Transform& now, const Transform& after,
                         double step);

}  // namespace ecorche::inline v1
