// Reads a motion file of any known format.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "skinning/motion_files/motion_clip.h"

namespace ecorche::inline v1 {

struct MotionReadOptions {
  // takes the place of the file's rate, which may then be nonsense
  std::optional<double> fps{};
  std::string take{};  // of a file that holds several: its name or number; empty: the first
};

// The format is told by the file's extension: .glb and .gltf; BVH is tried for every other one.
// Throws as read_bvh and gltf_motion.
MotionClip read_motion(const std::filesystem::path& file, const MotionReadOptions& options = {});

}  // namespace ecorche::inline v1
