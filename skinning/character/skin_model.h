// The skin of a character, compiled: constant, read by every frame. Copies share the tables.
#pragma once

#include <memory>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/geometry/subdivide.h"
#include "anatomy/posed_anatomy.h"
#include "skinning/bind/bind.h"
#include "skinning/muscle_collision/muscle_collision.h"
#include "skinning/settle/elastic_skin.h"

namespace ecorche::inline v1 {

// A refined skin as means of vertices of the posed base mesh, so that it is as smooth as a
// subdivision of that is. Both meshes in their sorted order.
struct RefinedMap {
  std::vector<int> first;     // #V + 1 into base, weight
  std::vector<int> base;      // vertices of the base mesh
  std::vector<float> weight;  // as of their positions at rest
  // #V x 4, m, rest pose, evaluation order: what the skin differs from these means by at rest, as
  // clothes do; empty where it is them.
  std::vector<float> offset;
};

struct SkinModel {
  std::shared_ptr<const BlendTables> blend;  // of the skin
  // Of the mesh that relaxes: the skin itself, or the base mesh of a refined one.
  std::shared_ptr<const BlendTables> base_blend;
  std::shared_ptr<const ElasticSkin> elastic;
  MuscleCollision collision;                  // empty: muscles do not lift the skin
  std::shared_ptr<const RefinedMap> refined;  // null: the skin itself relaxes
};

// `rest`: the anatomy's rest pose. `skin`: that was bound. `before`: of the same skin, bones and
// joints with other muscles, or null.
SkinModel make_skin_model(const Anatomy& anatomy, const PosedAnatomy& rest, const TriMesh& skin,
                          const BoundSkin& bound, const SkinModel* before = nullptr);

SkinModel make_refined_skin_model(const Anatomy& anatomy, const PosedAnatomy& rest,
                                  const TriMesh& base, const Refinement& refinement,
                                  const BoundRefinedSkin& bound, const SkinModel* before = nullptr);

}  // namespace ecorche::inline v1
