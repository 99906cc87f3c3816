// Where a scene's meshes are in its draw list; eyes follow the bones.
#pragma once

namespace ecorche {

inline constexpr int kSkinMesh = 0, kMuscleMesh = 1, kFasciaMesh = 2, kFirstBoneMesh = 3;

}  // namespace ecorche
