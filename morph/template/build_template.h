// Building the template from the packages and our tables.
#pragma once

#include "anatomy/anatomy.h"
#include "anatomy/files/assets.h"
#include "morph/placement/fitted_skeleton.h"
#include "morph/template/template.h"

namespace ecorche::inline v1 {

// Takes some seconds to a minute. Throws InputError for missing or altered inputs.
Template build_template(const Assets& assets);

// How build_template places the bone package's skeleton (read_source_skeleton) in the default body;
// some seconds.
SidedPlacement place_source(const Assets& assets, const Anatomy& source, const FitRules& rules);

}  // namespace ecorche::inline v1
