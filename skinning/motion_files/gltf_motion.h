// Motions of glTF files: an animation of nodes as a clip.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "anatomy/types.h"
#include "skinning/motion_files/motion_clip.h"

namespace ecorche::inline v1 {

struct GltfMotionOptions {
  std::optional<double> fps;  // frames a second that keys are sampled at; by the keys when left out
  std::string take;           // name of the animation or its number from 1; empty: the first
};

// Joints are those of the file's skins, or without skins the nodes that move; the rest pose is that
// of the skin's binding. All kinds of interpolation are sampled. `folder`: of a .gltf whose buffers
// lie beside it. Throws InputError, LimitError; UnfitError for a file without animation, or for
// another take, with the names that there are.
MotionClip gltf_motion(std::string_view bytes, const std::string& name,
                       const GltfMotionOptions& options = {},
                       std::optional<std::filesystem::path> folder = std::nullopt);

// A node that is looked for; of several with its name, the one of its number, else the first.
struct NodeName {
  std::string name;  // "joint 12" for number 12 without a name
  std::size_t number = 0;
};

// An animation of nodes as it stands in the file: world maps, in its units and axes.
struct NodeMotion {
  double fps = 30;
  std::vector<Affine> standing;             // #nodes: without animation
  std::vector<Affine> above;                // of the nodes above them, likewise
  std::vector<std::vector<Affine>> frames;  // by frame, #nodes
  std::vector<std::string> warnings;
};

// None where a node is missing, or none of them moves. Throws as gltf_motion.
std::optional<NodeMotion> gltf_node_motion(
    std::string_view bytes, const std::string& name, const std::vector<NodeName>& nodes,
    const GltfMotionOptions& options = {},
    std::optional<std::filesystem::path> folder = std::nullopt);

// Names without the numbers that some exporters hang on all of them ("Hips_01", "Spine_02").
void drop_numbers(std::vector<std::string>& names);

}  // namespace ecorche::inline v1
