// ecorche sit: a person sits on a chair; film or picture, pressure map.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_sit_verb(VerbRegistry& registry);

}  // namespace ecorche
