// What a detailed skin has beyond a smooth one, as pictures on the skin's texture.
//
// Both skins have the same triangles. A texel has the displacement along the smooth skin's normal,
// and the detailed skin's normal in the smooth skin's tangent space (right along the texture, up
// along it, out), as glTF's normalTexture has it. What lies beyond a seam goes on for some texels,
// so that filtering finds no border.
#pragma once

#include <cstdint>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct DetailedSkin {
  TriMesh smooth;
  Points detailed;                          // #V x 3
  std::vector<Eigen::RowVector2f> corners;  // 3 #F, on the texture, (0, 0) at the lower left
};

struct SkinMaps {
  int size = 0;                            // texels a side; top row first
  std::vector<std::uint8_t> normals;       // 3 a texel; (128, 128, 255) where there is no skin
  std::vector<std::uint8_t> displacement;  // 1 a texel: 0 is -range, 128 none, 255 +range
  double range = 0;                        // m
};

// Throws std::invalid_argument for skins and corners that do not go together, and a size that is
// not above 0.
SkinMaps skin_maps(const DetailedSkin& skin, int size);

}  // namespace ecorche::inline v1
