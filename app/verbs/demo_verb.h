// ecorche demo: an athlete's long jump, from the template to the film.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_demo_verb(VerbRegistry& registry);

}  // namespace ecorche
