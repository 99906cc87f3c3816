// Hands that registration could not follow, held still.
#pragma once

#include <vector>

#include "anatomy/base_mesh/body_rig.h"
#include "morph/registration/registration.h"

namespace ecorche::inline v1 {

// The registration with each hand that is bent, crumpled or hardly seen moved as one piece, from
// the wrist on, so that what hangs on it (a fist, a glove, a stylised hand) keeps its own shape.
// `parts`: of the base mesh's vertices (body_rig.h).
Registration with_still_hands(Registration registration, const std::vector<VertexPart>& parts);

}  // namespace ecorche::inline v1
