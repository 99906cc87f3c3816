#include "viewer/scene_meshes.h"

#include <cstddef>
#include <memory>
#include <utility>

namespace ecorche {
namespace {

// All that does not change from frame to frame. Skin and muscles are written in every frame.
bool alike(const DrawMesh& a, const DrawMesh& b, bool moves) {
  return a.triangles == b.triangles && a.parts == b.parts && a.fibres == b.fibres &&
         a.positions.size() == b.positions.size() && (moves || a.positions == b.positions) &&
         a.dissolve == b.dissolve;
}

void keep(const DrawMesh& before, DrawMesh& mesh, bool moves) {
  if (alike(before, mesh, moves)) mesh.key = before.key;
}

}  // namespace

void keep_alike(const SceneModel& before, SceneModel& model) {
  keep(before.skin, model.skin, true);
  keep(before.muscles, model.muscles, true);
  keep(before.fascia, model.fascia, true);
  for (std::size_t b = 0; b < model.bones.size() && b < before.bones.size(); ++b)
    keep(before.bones[b], model.bones[b], false);
  for (std::size_t e = 0; e < model.eyes.size() && e < before.eyes.size(); ++e)
    keep(before.eyes[e], model.eyes[e], false);
  if (!before.coarse || !model.coarse) return;
  auto coarse = std::make_shared<SceneModel>(*model.coarse);
  keep_alike(*before.coarse, *coarse);
  model.coarse = std::move(coarse);
}

}  // namespace ecorche
