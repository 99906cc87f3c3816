// Foot planting: feet in contact stand still on the ground.
#pragma once

#include <array>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/foot_contacts.h"
#include "skinning/constraints/ground_points.h"
#include "skinning/constraints/motion_report.h"

namespace ecorche::inline v1 {

// Spans in which heels and balls stand, on the feet's paths as the source had them; not yet
// measured (measure_feet.h). paths[0] is the left foot.
std::vector<Contact> find_contacts(const std::array<FootPaths, 2>& paths, const Motion& motion);

// Shifts the motion so that its feet stand on y = 0, then holds each planted heel and ball at its
// position, levels flat feet, bends the toes where the heel rises, and keeps soles out of the
// ground. Corrections fade over 0.1 s around each contact. The pelvis is lowered, smoothly, where a
// planted leg would be too short. `contacts`: as find_contacts gives them, also of an edited
// motion. `strength`: share of what feet are off that is corrected, 0 to 1; feet are never left in
// the ground. `lift`: m, by frame, by which the figure then rises from its planted feet; or empty.
// `flesh`: a foot that stands on an edge of its sole, or on toes whose ball bulges, is raised by
// what else would be deeper than 1 mm; null: feet are heel, ball and tip of the toes alone.
void plant_feet(const Skeleton& skeleton, double sole_height, const std::vector<Contact>& contacts,
                double strength, const std::vector<double>& lift, const GroundPoints* flesh,
                Motion& motion);

}  // namespace ecorche::inline v1
