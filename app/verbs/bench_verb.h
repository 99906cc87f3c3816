// ecorche bench: speed as ratios of cases within one run. Each case counts by the least CPU time
// of its interleaved repetitions.
#pragma once

#include "app/verbs/verb.h"

namespace ecorche {

void add_bench_verb(VerbRegistry& registry);

}  // namespace ecorche
