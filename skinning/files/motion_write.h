// A motion alone as .glb: the joints of a skeleton and an animation of them.
#pragma once

#include <filesystem>
#include <string>

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// Nodes by our joints' names, metres, +Y up, with a glTF skin over them so that programs take them
// for a skeleton, and no mesh; a key a frame. Throws OutputError; std::invalid_argument for a
// motion without frames, or of another skeleton.
void write_motion_glb(const std::filesystem::path& file, const Skeleton& skeleton,
                      const Motion& motion, const std::string& name);

}  // namespace ecorche::inline v1
