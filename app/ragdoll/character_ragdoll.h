// The ragdoll of a character. Shared by the verbs fall and animate.
#pragma once

#include <string>
#include <vector>

#include "anatomy/character.h"
#include "app/common_options.h"
#include "app/report.h"
#include "skinning/binding.h"
#include "skinning/ragdoll/ragdoll.h"

namespace ecorche {

// Segments as segment_inertia() has them; figures go to the report under `inertia`. Throws
// UnfitError that names `file`, for a skeleton without our joints and as segment_inertia().
Ragdoll character_ragdoll(const std::string& file, const Character& character,
                          const Binding& binding, Report& report);

// The height of the ground: of the soles at rest.
double ground_height(const Character& character);

// Names of --passive. Throws UsageError for joints that are none.
void require_limp_joints(const Skeleton& skeleton, const std::vector<std::string>& joints);

// --passive: joints of the motion go limp. Returns the motion with them swinging; a note and the
// report (`limp`) say which and how. Throws UsageError for joints that are none or cannot swing.
Motion with_limp_joints(const std::string& file, const Character& character, const Binding& binding,
                        const std::vector<std::string>& joints, const Motion& motion,
                        const Common& common, Report& report);

}  // namespace ecorche
