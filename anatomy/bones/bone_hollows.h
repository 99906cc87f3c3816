// Hollows that the bone package's meshes leave flat (data/hollows.csv): where a bone is pressed in
// to make room for the muscle in it.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/files/csv_table.h"

namespace ecorche::inline v1 {

// Moves vertices of `bones` that lie within a hollow's rim, seen along the rim's mean normal, and
// face the way it does. Bones are in the source skeleton's frame (bone_package.h), m; a hollow of
// an unpaired bone is pressed into both of its sides. Rims are read from the table's left side.
// Throws InputError for a bone that is not there or a rim of fewer than three points.
void press_hollows(const Table& table, std::vector<Bone>& bones);

}  // namespace ecorche::inline v1
