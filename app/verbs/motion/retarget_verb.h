// ecorche retarget: a motion on a character's skeleton, without the character.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_retarget_verb(VerbRegistry& registry);

}  // namespace ecorche
