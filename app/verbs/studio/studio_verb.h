// `ecorche studio`: muscles, joints and body changed by actions, live or by script.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_studio_verb(VerbRegistry& registry);

}  // namespace ecorche
