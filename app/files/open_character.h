// Characters as command lines name them: a file, or one person of a crowd.
#pragma once

#include <filesystem>

#include "anatomy/character.h"
#include "app/common_options.h"
#include "app/report.h"

namespace ecorche {

// A character's file; or "crowd.glb#ada", a person of a crowd, whose bones and muscles are fitted
// into the crowd's skin, as `fit` does it. Throws as read_character, read_crowd_person and
// fit_unbound; InputError for a crowd without a name, which names its people.
Character open_character(const std::filesystem::path& file, const Common& common, Report& report);

}  // namespace ecorche
