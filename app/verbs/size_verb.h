// ecorche body size: feature points of a body, the nearest standard clothing size, and the
// alterations that make it fit.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_body_size(VerbRegistry& registry, CLI::App& body);

}  // namespace ecorche
