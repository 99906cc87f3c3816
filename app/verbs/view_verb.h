// ecorche view: the window. Without a character it shows the template in its own body.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_view_verb(VerbRegistry& registry);

}  // namespace ecorche
