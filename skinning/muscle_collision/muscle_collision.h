// Collision of muscles with the skin from beneath: muscles stay under it. Tables, compiled once.
//
// The skin settles by tension, volume and contact of its own, so that a muscle's section may come
// nearer to it than at rest, or through it. Probes are points of every section's outline that are
// near the skin at rest; in a pose they are projected onto the skin by walking over the mesh from
// their place at rest. lift_skin_over_muscles.h lifts the skin over probes that are out by a part
// of the way, smoothly round about, but not in folds and where it meets itself; the tissue for that
// comes from where no muscle is near: body and limbs keep their volumes. push_muscles.h then
// presses outlines that are still out, and moves sections inward where pressing alone is not
// enough; bellies take their volume again. Points of bones near the skin are probes, too, over
// which keep_skin_over_bones.h lifts the skin. At rest nothing moves. A function of skin and slices
// alone. A refined skin follows its base mesh in this too.
#pragma once

#include <memory>

#include "anatomy/anatomy.h"
#include "anatomy/posed_anatomy.h"

namespace ecorche::inline v1 {

struct CollisionTables;  // collision_tables.h

struct MuscleCollision {
  std::shared_ptr<const CollisionTables> data;  // null: no collision

  bool empty() const { return data == nullptr; }
};

// `rest`: the anatomy's rest pose, without contact or with it. `skin`: the rest shape of the mesh
// that relaxes, in its vertex order. `before`: of the same skin, bones and joints, whose probes of
// bones are taken over.
MuscleCollision make_muscle_collision(const Anatomy& anatomy, const PosedAnatomy& rest,
                                      const TriMesh& skin, const MuscleCollision& before = {});

}  // namespace ecorche::inline v1
