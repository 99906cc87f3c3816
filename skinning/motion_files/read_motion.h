// Reads a motion file of any known format.
#pragma once

#include <filesystem>
#include <optional>

#include "skinning/motion_files/motion_clip.h"

namespace ecorche::inline v1 {

struct MotionReadOptions {
  std::optional<double> fps;  // takes the place of the file's rate, which may then be nonsense
};

// The format is told by the file's extension. BVH is the only one so far, and is tried for every
// other extension too. Throws as read_bvh.
MotionClip read_motion(const std::filesystem::path& file, const MotionReadOptions& options = {});

}  // namespace ecorche::inline v1
