// ecorche template resample: a muscle mesh resampled to elliptic cross-sections along an action
// line, and lofted back.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_template_resample(VerbRegistry& registry, CLI::App& template_verb);

}  // namespace ecorche
