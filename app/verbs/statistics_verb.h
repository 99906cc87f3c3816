// ecorche body statistics: how bodies vary together, what age, mass and stature do to them, and
// where a body lies among people.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_body_statistics(VerbRegistry& registry, CLI::App& body);

}  // namespace ecorche
