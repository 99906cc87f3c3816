// Which meshes of a scene are taken over from the one before.
#pragma once

#include "viewer/scene.h"

namespace ecorche {

// Meshes of `model` that are as those of `before` take their keys, so that they are neither copied
// nor uploaded again where both are drawn in turn.
void keep_alike(const SceneModel& before, SceneModel& model);

}  // namespace ecorche
