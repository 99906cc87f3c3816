// Lifts the skin over muscles that come out of it. Private to the library.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "skinning/muscle_collision/collision_workspace.h"
#include "skinning/muscle_collision/muscle_collision.h"
#include "skinning/relaxed_skin.h"

namespace ecorche::inline v1 {

// Result of lift_skin_over_muscles(), which push_muscles_below_skin() reads.
struct SkinLift {
  bool lifted = false;
  // #V, 0 where a muscle is at the surface .. 1 where none is near: there the skin may sink again
  std::vector<float> clearance;
  std::vector<char> exposed;  // #owners of probes: whether one is out, or nearly so
};

// Lifts skin.positions by skin.liftable; where it does, skin.openness falls with the clearance.
// Throws std::invalid_argument where slices and skin are not of what the tables were made of. The
// same bytes at any number of threads.
void lift_skin_over_muscles(const MuscleCollision& collision, std::span<const Ellipse> slices,
                            RelaxedSkin& skin, SkinLift& lift, LiftWorkspace& workspace);

}  // namespace ecorche::inline v1
