// ecorche completion and ecorche man: completion scripts for shells, and the manual page.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_shell_verbs(VerbRegistry& registry);

}  // namespace ecorche
