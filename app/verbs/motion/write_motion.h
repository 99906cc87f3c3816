// A motion alone, in the format that a file's ending asks for.
#pragma once

#include <filesystem>
#include <string>

#include "anatomy/skeleton.h"
#include "app/common_options.h"

namespace ecorche {

// Writes .bvh, .fbx or else .glb and says how many frames it has. `take`: the motion's name in the
// file.
void write_motion(const std::filesystem::path& output, const Skeleton& skeleton,
                  const Motion& motion, const std::string& take, const Common& common);

// How many frames a file has.
void note_written(const std::filesystem::path& output, const Motion& motion, const Common& common);

}  // namespace ecorche
