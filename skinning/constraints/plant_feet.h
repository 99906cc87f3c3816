// Foot planting: feet in contact stand still on the ground.
#pragma once

#include <array>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/foot_contacts.h"
#include "skinning/constraints/motion_report.h"

namespace ecorche::inline v1 {

// Shifts the motion so that its feet stand on y = 0, then holds each planted heel and ball at its
// position, levels flat feet, bends the toes where the heel rises, and keeps soles out of the
// ground. Corrections fade over 0.1 s around each contact. The pelvis is lowered, smoothly, where a
// planted leg would be too short. paths[0] is the left foot. Returns the contacts, not yet measured
// (measure_feet.h).
std::vector<Contact> plant_feet(const Skeleton& skeleton, double sole_height,
                                const std::array<FootPaths, 2>& paths, Motion& motion);

}  // namespace ecorche::inline v1
