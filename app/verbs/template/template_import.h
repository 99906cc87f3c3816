// ecorche template import: a musculoskeletal model of OpenSim or MuJoCo as a template.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_template_import(VerbRegistry& registry, CLI::App& template_verb);

}  // namespace ecorche
