// ecorche export: a character as a musculoskeletal model for OpenSim or MuJoCo.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_export_verb(VerbRegistry& registry);

}  // namespace ecorche
