// ecorche template sweep: lengths of the action lines while each joint turns through its range.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_template_sweep(VerbRegistry& registry, CLI::App& template_verb);

}  // namespace ecorche
