// ecorche list: the names that options and tables take.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_list_verb(VerbRegistry& registry);

}  // namespace ecorche
