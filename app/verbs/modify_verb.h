// ecorche body modify: the same person with other measurements, fat, muscle or age, or caricatured.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_body_modify(VerbRegistry& registry, CLI::App& body);

}  // namespace ecorche
