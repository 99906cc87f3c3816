#include "app/painted_skin.h"

#include "skinning/painted_weights.h"

namespace ecorche {

void add_weights_option(CLI::App& verb, std::filesystem::path& weights) {
  verb.add_option("--weights", weights, "Table of weights set by hand (CSV: vertex, joint, weight), in place of what is found by itself; `ecorche weights` writes one");
}

void paint_skin(const std::filesystem::path& weights, Actor& actor, Report& report) {
  if (weights.empty()) return;
  const Anatomy& anatomy = actor.character.anatomy;
  const TriMesh& skin = actor.character.body.skin;
  const std::optional<BaseSkin> base = find_base(skin);
  const PaintedWeights painted = read_painted_weights(weights, anatomy, static_cast<int>(base ? base->mesh.V.rows() : skin.V.rows()));
  PosedAnatomy rest;
  pose_anatomy(actor.table, anatomy.skeleton, rest_pose(anatomy.skeleton), rest);
  actor.binding = base ? bind_skin(anatomy, rest, base->mesh, base->refinement, skin, painted) : bind_skin(anatomy, rest, skin, painted);
  report.set("weights.painted_vertices", static_cast<int>(painted.vertices.size()));
}

}  // namespace ecorche
