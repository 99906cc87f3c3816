#include "viewer/scene_meshes.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace ecorche {
namespace {

// All that does not change from frame to frame. Skin and muscles are written in every frame.
bool alike(const DrawMesh& a, const DrawMesh& b, bool moves) {
  return a.triangles == b.triangles && a.coarse == b.coarse && a.parts == b.parts &&
         a.fibres == b.fibres && a.positions.size() == b.positions.size() &&
         (moves || a.positions == b.positions) && a.dissolve == b.dissolve;
}

void keep(const DrawMesh& before, DrawMesh& mesh, bool moves) {
  if (alike(before, mesh, moves)) mesh.key = before.key;
}

}  // namespace

void take_meshes(const SceneModel& model, Scene& scene) {
  std::vector<DrawMesh>& own = scene.list.meshes;
  std::vector<const DrawMesh*> wanted{&model.skin, &model.muscles, &model.fascia};
  for (const DrawMesh& bone : model.bones) wanted.push_back(&bone);
  for (const DrawMesh& eye : model.eyes) wanted.push_back(&eye);
  const auto is_there = [&](std::size_t k) {
    const bool moves = k < std::size_t(kFirstBoneMesh);
    return own[k].key == wanted[k]->key && (moves || own[k].revision == wanted[k]->revision) &&
           (k != std::size_t(kSkinMesh) ||
            own[k].positions.size() == wanted[k]->positions.size()) &&
           own[k].fibres.size() == wanted[k]->fibres.size();
  };
  own.resize(wanted.size());
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    if (is_there(k) && wanted[k]->key != 0) continue;
    own[k] = *wanted[k];
    if (k == std::size_t(kMuscleMesh) || k == std::size_t(kFasciaMesh))
      scene.parts_left_away.assign(1, kSkinPart);  // no such part: taken anew
  }
}

void keep_alike(const SceneModel& before, SceneModel& model) {
  keep(before.skin, model.skin, true);
  keep(before.muscles, model.muscles, true);
  keep(before.fascia, model.fascia, true);
  for (std::size_t b = 0; b < model.bones.size() && b < before.bones.size(); ++b)
    keep(before.bones[b], model.bones[b], false);
  for (std::size_t e = 0; e < model.eyes.size() && e < before.eyes.size(); ++e)
    keep(before.eyes[e], model.eyes[e], false);
}

}  // namespace ecorche
