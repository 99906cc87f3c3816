// The deformers to beat: plain linear blend and dual quaternion skinning with four influences,
// positions and normals.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "anatomy/types.h"
#include "skinning/skin_frame.h"

namespace ecorche::inline v1 {

struct BlendSkin {
  std::vector<float> positions;               // #V x 3, rest
  std::vector<float> normals;                 // #V x 3, rest
  std::vector<std::array<int, 4>> bones;      // #V
  std::vector<std::array<float, 4>> weights;  // #V, sum 1
  int bone_count = 0;                         // every index is below it
};

struct BoneWeight {
  int bone = 0;
  double weight = 0;
};

// Keeps the four largest influences of each vertex and normalises them. Rest normals are area
// weighted.
BlendSkin make_blend_skin(const TriMesh& rest, std::span<const std::vector<BoneWeight>> weights);

// `bones`: world map of each bone from rest to pose. No working memory; one thread.
void deform_linear(const BlendSkin& skin, std::span<const Transform> bones, SkinFrame& out);
void deform_dual_quaternion(const BlendSkin& skin, std::span<const Transform> bones,
                            SkinFrame& out);

}  // namespace ecorche::inline v1
