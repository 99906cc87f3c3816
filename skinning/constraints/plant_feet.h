// Planted feet stand still on the ground.
#pragma once

#include <array>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/foot_contacts.h"
#include "skinning/retarget/retarget.h"

namespace ecorche {

// Shifts the motion so that its feet stand on y = 0, then holds each planted heel and ball at its
// place, levels flat feet, lets the toes bend where the heel rises, and keeps soles out of the
// ground; fades over 0.1 s around each contact. The pelvis is lowered, smoothly, where a planted
// leg would be too short. paths[0] is the left foot. Fills contacts, slide_p95, penetration of the
// report.
void plant_feet(const Skeleton& skeleton, double sole_height, const std::array<FootPaths, 2>& paths,
                Motion& motion, RetargetReport& report);

// Measures the contacts of report.contacts and the soles' depth on a motion as it is.
void measure_feet(const Skeleton& skeleton, double sole_height, const Motion& motion,
                  RetargetReport& report);

}  // namespace ecorche
