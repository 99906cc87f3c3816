// ecorche template: its verbs; `template info`, the template's contents, and `template check`,
// whether it keeps its promises.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_template_verb(VerbRegistry& registry);

}  // namespace ecorche
