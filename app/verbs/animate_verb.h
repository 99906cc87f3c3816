// ecorche animate: a motion on a character, written as an animated .glb, vertex caches or tables.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_animate_verb(VerbRegistry& registry);

}  // namespace ecorche
