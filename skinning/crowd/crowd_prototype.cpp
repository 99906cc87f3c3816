#include "skinning/crowd/crowd_prototype.h"

#include <utility>

#include "anatomy/errors.h"
#include "anatomy/geometry/join_meshes.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"
#include "skinning/files/slice_influences.h"

namespace ecorche::inline v1 {
namespace {

MuscleSurface crowd_surface(const Anatomy& anatomy) {
  MuscleSurfaceOptions options;
  options.points_per_slice = 8;  // people of a crowd are seen from afar
  return make_muscle_surface(anatomy, options);
}

void add_bones(const Anatomy& anatomy, CrowdPrototype::Layer& layer) {
  for (const Bone& bone : anatomy.bones) {
    const auto begin = int(layer.influences.size()), end = begin + int(bone.mesh.V.rows());
    layer.parts.push_back({bone.name, begin, end});
    layer.influences.resize(end, {Influence{bone.joint, 1}});
  }
}

void add_muscles(const Anatomy& anatomy, CrowdPrototype::Layer& layer) {
  const MuscleSurface surface = crowd_surface(anatomy);
  const std::vector<std::array<Influence, 4>> by_slice = slice_influences(anatomy);
  for (int slice : surface.slice) layer.influences.push_back(by_slice[slice]);
  for (const MuscleSurface::Part& part : surface.parts)
    layer.parts.push_back({anatomy.muscles[part.muscle].name, part.vertex_begin, part.vertex_end});
}

}  // namespace

std::vector<TriMesh> crowd_meshes(const Character& character, CrowdLayers layers) {
  if (layers == CrowdLayers::skin_alone) return {character.body.skin};
  const MuscleSurface surface = crowd_surface(character.anatomy);
  std::vector<TriMesh> out{character.body.skin, joined_bones(character.anatomy),
                           TriMesh{Points(), surface.F}};
  update_muscle_surface(surface, rest_slices(character.anatomy), out[2].V);
  return out;
}

CrowdPrototype make_crowd_prototype(const Character& character, CrowdLayers layers) {
  if (character.anatomy.skeleton.joints.size() > 256)
    throw LimitError("a crowd's people have at most 256 joints");
  CrowdPrototype out;
  out.skeleton = character.anatomy.skeleton;
  static constexpr const char* kNames[] = {"skin", "bones", "muscles"};
  for (TriMesh& mesh : crowd_meshes(character, layers)) {
    const std::size_t vertices = mesh.V.rows();
    out.layers.push_back({kNames[out.layers.size()], std::move(mesh.F), vertices, {}, {}});
  }
  if (layers == CrowdLayers::skin_alone) return out;
  add_bones(character.anatomy, out.layers[1]);
  add_muscles(character.anatomy, out.layers[2]);
  return out;
}

}  // namespace ecorche::inline v1
