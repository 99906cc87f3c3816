// ecorche inertia: mass, centre and inertia of a character's segments.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_inertia_verb(VerbRegistry& registry);

}  // namespace ecorche
