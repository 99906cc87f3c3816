// Keeps the skin over bones that come out of it. Private to the library.
#pragma once

#include <span>

#include "anatomy/anatomy.h"
#include "skinning/muscle_collision/collision_workspace.h"
#include "skinning/muscle_collision/muscle_collision.h"
#include "skinning/relaxed_skin.h"

namespace ecorche::inline v1 {

// Lifts skin.positions along its normals over points of bones that are out of it, smoothly round
// about and no farther than folds allow: where more would be needed, bones stay out. Writes
// skin.normals anew in any case. Bones do not give way, so that this comes last, after volumes and
// contact. Throws std::invalid_argument where joints and skin are not of what the tables were made
// of. The same bytes at any number of threads.
void keep_skin_over_bones(const MuscleCollision& collision, std::span<const Transform> X_WJ,
                          RelaxedSkin& skin, LiftWorkspace& workspace);

}  // namespace ecorche::inline v1
