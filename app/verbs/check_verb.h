// ecorche check: quality figures of an anatomy beside their targets, muscle by muscle, with
// pictures.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_check_verb(VerbRegistry& registry);

}  // namespace ecorche
