// A motion of a character's own skeleton on our joints: as its file has it, without any guess.
//
// The file's joints carry its mesh from where it stands; ours take the pose that carries the same
// mesh nearest to there, as the standing pose was found. Which of the file's joints moves which of
// ours is told by the weights of both, so that names, rest pose, units and axes do not matter.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "anatomy/own_skin.h"
#include "anatomy/skeleton.h"
#include "skinning/binding.h"
#include "skinning/motion_files/gltf_motion.h"

namespace ecorche::inline v1 {

struct OwnMotion {
  Motion motion;
  std::vector<std::string> warnings;
};

// An animation of a glTF file, where it is one of the joints that move the own skin: all of them
// are there by name, and no bone has another length or direction from its parent. None for a motion
// of another skeleton and an own skin without a rig. `rest`, `weights`: of the own skin by our
// joints. `folder`: as gltf_motion. Throws as gltf_motion and read_source_rig.
std::optional<OwnMotion> own_motion(std::string_view bytes, const std::string& name,
                                    const GltfMotionOptions& options, const OwnSkin& own,
                                    const Skeleton& ours, const Points& rest,
                                    const std::vector<JointWeights>& weights,
                                    std::optional<std::filesystem::path> folder = std::nullopt);

}  // namespace ecorche::inline v1
