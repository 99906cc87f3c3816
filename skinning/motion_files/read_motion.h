// Reads a motion file of any known format.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "skinning/motion_files/clip_times.h"
#include "skinning/motion_files/motion_clip.h"

namespace ecorche::inline v1 {

struct MotionReadOptions {
  // takes the place of the file's rate, which may then be nonsense
  std::optional<double> fps{};
  std::string take{};  // of a file that holds several: its name or number; empty: the first
  // of .amc and DeepMimic, whose skeletons are files of their own; empty: looked for beside it
  std::filesystem::path skeleton{};
  ClipRange range{};  // the part that is kept
};

// FBX, COLLADA, DeepMimic and NumPy's archives are told by how they begin, .glb and .gltf, .amc,
// .mot and .sto by their endings; BVH is tried for every other file. Throws as their readers;
// InputError where a skeleton is needed and not found; UnfitError for markers, which read_markers.h
// reads; UsageError for a take, skeleton or range that the file does not have.
MotionClip read_motion(const std::filesystem::path& file, const MotionReadOptions& options = {});

// Whether a file has an ending that motions alone have: .bvh, .amc, .mot, .sto, .txt, .json,
// .npz, .trc, .c3d.
bool names_motion(const std::filesystem::path& file);

// .trc, .c3d.
bool is_marker_file(const std::filesystem::path& file);

// .glb, .gltf, or what is read as one: FBX, COLLADA.
bool is_scene_motion(const std::filesystem::path& file);

// The bytes of a scene as glTF. Throws as read_input_file and import_scene.
std::string read_scene_motion(const std::filesystem::path& file);

}  // namespace ecorche::inline v1
