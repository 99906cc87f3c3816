// ecorche dynamics: the forces behind a motion.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_dynamics_verb(VerbRegistry& registry);

}  // namespace ecorche
