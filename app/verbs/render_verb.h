// ecorche render: a motion of a character as a film or pictures, or one moment of it as a still.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_render_verb(VerbRegistry& registry);

}  // namespace ecorche
