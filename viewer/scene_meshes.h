// Where a scene's meshes are in its draw list, and which of them are taken over from the scene
// before.
#pragma once

#include "viewer/scene.h"

namespace ecorche {

// Indices in the list; eyes follow the bones.
inline constexpr int kSkinMesh = 0, kMuscleMesh = 1, kFasciaMesh = 2, kFirstBoneMesh = 3;

// Copies the model's meshes into the list, in this order, unless they are already there.
void take_meshes(const SceneModel& model, Scene& scene);

// Meshes of `model` that are as those of `before` take their keys, so that they are neither copied
// nor uploaded again where both are drawn in turn.
void keep_alike(const SceneModel& before, SceneModel& model);

}  // namespace ecorche
