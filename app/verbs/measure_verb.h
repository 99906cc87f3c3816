// ecorche body measure: lengths, girths and mass of a body, as an anthropometrist takes them.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_body_measure(VerbRegistry& registry, CLI::App& body);

}  // namespace ecorche
