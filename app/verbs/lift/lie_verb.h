// ecorche lie: a person rests on a mattress; picture and pressure map.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_lie_verb(VerbRegistry& registry);

}  // namespace ecorche
