// ecorche body register: a scan, sculpt or character of any topology -> a body on the base mesh.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_body_register(VerbRegistry& registry, CLI::App& body);

}  // namespace ecorche
