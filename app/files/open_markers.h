// Takes of markers as motions for a character.
#pragma once

#include <filesystem>

#include "anatomy/character.h"
#include "anatomy/files/assets.h"
#include "app/common_options.h"
#include "app/options/motion_options.h"
#include "app/report.h"
#include "skinning/motion_files/motion_clip.h"

namespace ecorche {

// Reads a .trc or .c3d and finds the motion of the character's joints at the size of the person who
// wore the markers (skinning/markers). What was found goes to the report under `markers`; what
// people should know of it, such as a body of another size, to them too. Throws as read_markers,
// read_marker_tables and fit_markers. `start`: s, of the first frame by the clock of the file.
MotionClip open_markers(const std::filesystem::path& file, const Character& character,
                        const MotionOptions& options, const Common& common, Report& report,
                        double& start);

}  // namespace ecorche
