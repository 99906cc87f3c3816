// ecorche lift: a person is lifted in a patient sling; film, pressure map, forces.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_lift_verb(VerbRegistry& registry);

}  // namespace ecorche
