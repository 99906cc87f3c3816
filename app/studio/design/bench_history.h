// What a long session of edits takes: memory of its history, and time of its undos.
#pragma once

#include "app/common_options.h"
#include "app/report.h"

namespace ecorche {

struct HistoryCost {
  double megabytes = 0;     // of the heap, that the edits have added
  double longest_undo = 0;  // s, of single ones, the first and the last included
};

// Moves a point of one muscle after the other, both sides, and takes all of it back.
HistoryCost bench_history(const Common& common, Report& report, int edits);

}  // namespace ecorche
