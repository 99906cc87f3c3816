// ecorche fit: bones and muscles fitted into a skin, and the skin bound to them.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_fit_verb(VerbRegistry& registry);

}  // namespace ecorche
