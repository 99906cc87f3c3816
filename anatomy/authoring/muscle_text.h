// Muscles, wraps and sections as the text of data/muscles: the way back from the muscle table.
#pragma once

#include <string>

#include "anatomy/authoring/muscle_table.h"

namespace ecorche::inline v1 {

// A block that read_muscle_text() reads into a table with the same landmarks and wraps. Lengths are
// rounded to 0.1 micrometre, shares and directions to the sixth digit: what was read from such a
// block gives the same block again. Precondition: `muscle` refers to `table`.
std::string muscle_text(const MuscleTable& table, const TableMuscle& muscle);

// A line of wraps.txt.
std::string wrap_text(const MuscleTable& table, const TableWrap& wrap);

}  // namespace ecorche::inline v1
