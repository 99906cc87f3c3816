// ecorche body: its verbs, and `body new`, a body of given sex, age, height and mass, or of given
// measurements.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_body_verb(VerbRegistry& registry);

}  // namespace ecorche
