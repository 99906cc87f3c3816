// ecorche weights: skin weights of each joint, as a table to edit and as pictures.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_weights_verb(VerbRegistry& registry);

}  // namespace ecorche
