// The model of a scene for pictures that are drawn while something moves: the same parts over a
// fraction of the vertices, all bones in one mesh.
#pragma once

#include <memory>

#include "viewer/scene.h"

namespace ecorche {

// `reach`: about the sides of its triangles, m. Keys of its meshes follow those of `fine`.
std::shared_ptr<const SceneModel> make_coarse(const Anatomy& anatomy, const SceneModel& fine,
                                              double reach);

}  // namespace ecorche
