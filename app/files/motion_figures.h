// Figures of a motion on an actor, in the report. Shared by the verbs animate and demo.
#pragma once

#include <string>

#include "anatomy/files/assets.h"
#include "app/files/actor.h"
#include "app/report.h"
#include "skinning/checks/motion_survey.h"

namespace ecorche {

// play_motion() of the model by the actor's method.
MotionQuality play_motion(const Actor& actor, const Motion& motion, MotionRun run);

// The same poses by every method that there is: flipped triangles and stretch, worst frame, under
// `skins.<method>`. Without the body package or with a skin of another topology only our own is
// measured.
void compare_skins(const Assets& assets, const Actor& actor, const Motion& motion, Report& report);

// Under `prefix`: stable names, see docs/report.md.
void report_quality(const MotionQuality& quality, const std::string& prefix, Report& report);

}  // namespace ecorche
