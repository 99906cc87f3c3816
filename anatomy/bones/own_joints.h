// The joints that our own skeleton has to have.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// Whether a joint of data/joints.csv, by its name without side, is of a finger or a toe: their
// bones may be missing.
bool is_of_digit(std::string_view name);

// Throws UnfitError "FILE: ..." that names the first joint of data/joints.csv which the skeleton
// lacks or has under another one of these; joints of one's own may stand between. What moves,
// judges or exports a character asks for joints by these names.
// `tables`: Assets::tables.
void require_own_joints(const std::filesystem::path& tables, const Skeleton& skeleton,
                        const std::string& file);

}  // namespace ecorche::inline v1
