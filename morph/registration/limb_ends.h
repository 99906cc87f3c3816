// Which way hands and feet are turned: small and thin beside the body, they settle into the wrong
// half of a turn while everything moves at once.
//
// Each is tried in turns about its limb and across, fitted to what of the scan lies about it, and
// stays as it fits best, both ways.
#pragma once

#include <vector>

#include "morph/registration/articulated_fit.h"

namespace ecorche::inline v1 {

// Precondition: all else of the state lies on the scan. Turns of hands, thumbs, fingers, feet, toes
// and the twists above them change. Those of ends that the scan does not show are as at rest, and
// are returned.
std::vector<int> turn_limb_ends(const ArticulatedFit& fit, ArticulatedState& state);

}  // namespace ecorche::inline v1
