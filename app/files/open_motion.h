// Motions read from files for a character.
#pragma once

#include <filesystem>

#include "anatomy/character.h"
#include "app/common_options.h"
#include "app/options/motion_options.h"
#include "app/report.h"

namespace ecorche {

// Reads a motion file and retargets it to the character. What was assumed goes to the report under
// `motion`, warnings to people too.
Motion open_motion(const std::filesystem::path& file, const Character& character,
                   const MotionOptions& options, const Common& common, Report& report);

}  // namespace ecorche
