// ecorche fall: a person goes limp and falls; film or motion.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_fall_verb(VerbRegistry& registry);

}  // namespace ecorche
