// ecorche body population: bodies with their anatomy for a table of people, or for a random sample.
// A run that was ended goes on where it stopped.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_body_population(VerbRegistry& registry, CLI::App& body);

}  // namespace ecorche
