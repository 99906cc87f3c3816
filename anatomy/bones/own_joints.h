// The joints that our own skeleton has to have.
#pragma once

#include <filesystem>
#include <string>

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// Throws UnfitError "FILE: ..." that names the first joint of data/joints.csv which the skeleton
// lacks or has under another parent. What moves, judges or exports a character asks for joints by
// these names.
// `tables`: Assets::tables.
void require_own_joints(const std::filesystem::path& tables, const Skeleton& skeleton,
                        const std::string& file);

}  // namespace ecorche::inline v1
