// A bake as a .glb that engines play: the mesh node `skin` with joint influences and morph targets,
// the joint hierarchy with the helpers as further joints (`helper_01`, ...), and one animation a
// motion with the joints' rotations, the helpers' positions and the morph targets' curves. The
// scene's `extras.bake` state the error against the exact skin.
#pragma once

#include <filesystem>
#include <string>

#include "skinning/bake/baked_rig.h"

namespace ecorche::inline v1 {

// Morph targets are sparse: only the offsets that are not zero are stored. Throws OutputError.
void write_bake(const std::filesystem::path& file, const std::string& name, const TriMesh& skin,
                const Skeleton& skeleton, const Bake& bake);

}  // namespace ecorche::inline v1
