// ecorche bake: motions of a character as joints, skin weights, morph targets and curves for
// game engines.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_bake_verb(VerbRegistry& registry);

}  // namespace ecorche
