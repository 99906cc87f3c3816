// Reads a file of markers of any known format.
#pragma once

#include <filesystem>

#include "skinning/motion_files/marker_take.h"
#include "skinning/motion_files/read_motion.h"

namespace ecorche::inline v1 {

// Throws as parse_trc and parse_c3d; UsageError for a take or a skeleton, which these files do not
// have, and for a range that the file does not have.
MarkerTake read_markers(const std::filesystem::path& file, const MotionReadOptions& options = {});

}  // namespace ecorche::inline v1
