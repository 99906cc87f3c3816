// A bake as a .glb that engines play: the mesh node `skin` with joint influences and morph targets,
// the joint hierarchy with the helpers as further joints (`helper_01`, ...), and one animation a
// motion with the joints' rotations, the helpers' positions and the morph targets' curves. The
// scene's `extras.bake` state the error against the exact skin.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "anatomy/base_mesh/skin_texture.h"
#include "skinning/bake/baked_rig.h"

namespace ecorche::inline v1 {

// A normal map and where the skin lies on it.
struct BakeTexture {
  SkinTexture texture;  // of the skin
  std::vector<std::uint8_t> normals_png;
};

// Morph targets are sparse: only the offsets that are not zero are stored. With a texture vertices
// are split along its seams, and the material has its normal map. Throws OutputError.
void write_bake(const std::filesystem::path& file, const std::string& name, const TriMesh& skin,
                const Skeleton& skeleton, const Bake& bake, const BakeTexture* texture = nullptr);

}  // namespace ecorche::inline v1
