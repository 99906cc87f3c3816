// Pushes muscles below the skin. Private to the library.
#pragma once

#include "anatomy/contact/muscle_model.h"
#include "skinning/muscle_collision/collision_workspace.h"
#include "skinning/muscle_collision/lift_skin_over_muscles.h"
#include "skinning/muscle_collision/muscle_collision.h"
#include "skinning/relaxed_skin.h"

namespace ecorche::inline v1 {

struct PushParameters {
  float most_depth = 0.06f;   // m, bound of a penetration
  float held_below = 0.004f;  // m below the skin; what lies deeper is free to swell
  // Fraction of an outline's radius that it is pressed at most; more of it moves the section.
  double most_press = 0.35;
  // Excess of the press, since the belly swells back a part of it as its volume is restored.
  double over_press = 1.1;
  // Rounds, each of collision with the skin and contact among muscles: a muscle that gives way to
  // the one swells towards the other.
  int rounds = 2;
};

// Whether muscles that a pushed one comes to press give way to it. That folds them where many press
// each other: what a map has carried (interior/body_map.h) is better left.
enum class NeighbourContact { resolved, left };

// Moves sections and presses outlines of `posed` that are out of the skin; bellies take their
// volume again, and muscles give way to one another. `skin`: final, with its normals. `lift`: of
// the same frame. `muscles`: that they were posed by. Throws std::invalid_argument for a skin or a
// lift of other tables.
void push_muscles_below_skin(const MuscleCollision& collision, const MuscleModel& muscles,
                             const RelaxedSkin& skin, const SkinLift& lift, PosedAnatomy& posed,
                             PushWorkspace& workspace,
                             NeighbourContact contact = NeighbourContact::resolved);

}  // namespace ecorche::inline v1
