// ecorche posebook: difficult poses by several skinning methods, as sheets of pictures and a table
// of figures.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_posebook_verb(VerbRegistry& registry);

}  // namespace ecorche
