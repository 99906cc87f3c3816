// A motion of our own skeleton as a table of its joints' angles, and back.
//
// Columns are those of coordinates.h, the root's six first; behind them angles that hardly move and
// that models hold fixed, where this motion has them off their anatomical zero all the same.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/motion_files/motion_table.h"
#include "skinning/motion_files/opensim_read.h"

namespace ecorche::inline v1 {

// Angles in degrees, the root's way in metres.
MotionTable joint_angle_table(const Skeleton& skeleton, const Motion& motion);

// Whether a table has our coordinates: the root's turns, hips and knees.
bool has_own_angles(const CoordinateTable& table);

// The motion of a table with our coordinates; angles that it does not have are at their anatomical
// zero. On the skeleton that it was written from the motion comes back to a micrometre; another
// body takes the angles over, and the root's way from its own rest. `fps`: in place of what the
// table's times say; of a single row 30 when left out. `warnings`: columns that are not ours.
Motion motion_of_angles(const CoordinateTable& table, const Skeleton& skeleton,
                        std::optional<double> fps, std::vector<std::string>& warnings);

}  // namespace ecorche::inline v1
