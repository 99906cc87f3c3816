// Lifts the skin over points that penetrate it, smoothly round about and not in folds. Private to
// the room.
#pragma once

#include <span>
#include <vector>

#include "skinning/muscle_collision/collision_workspace.h"
#include "skinning/muscle_collision/project_to_skin.h"

namespace ecorche::inline v1 {

struct LiftParameters {
  float most_depth = 0.06f;  // m, bound of a penetration
  // Of a penetration that the skin is lifted; muscles give the rest. Larger: with arms held
  // forwards the back rises by a finger's breadth, and the belly sinks for its volume.
  float skin_fraction = 0.6f;
  int clearance_rounds = 2;     // of smoothing
  int spread_rounds = 8;        // of smoothing, the first half of them only upwards
  int easing_rounds = 4;        // of smoothing about folds
  float liftable_gain = 4;      // skin is lifted freely where it is at least a quarter liftable
  float fold_fraction = 0.12f;  // of the way to where normals of a fold meet
  float bone_fold_fraction = 0.45f;  // the same over bones
  int raise_rounds = 3;              // of smoothing upwards over bones
};

// m: deeper points leave the skin free to sink.
inline constexpr float kClearance = 0.005f;

// Moves the skin (#V x 4) along `normals` over points that are out of it, the less the less
// `liftable` (#V, 0 .. 1) it is. False where none is. `clearance`: #V, 0 where a point is at the
// surface .. 1 where none is near.
bool lift_skin(const SkinRings& rings, std::span<const SkinPenetration> points,
               std::span<const float> normals, std::span<const float> liftable,
               std::span<float> positions, std::vector<float>& clearance, LiftWorkspace& workspace);

// Lifts the skin in rounds over points that do not give way: raise_skin() for what is out then,
// after begin_raise() once. It moves along the first round's normals, and no farther than folds
// allow.
void begin_raise(const SkinRings& rings, std::span<const float> positions,
                 std::span<const float> normals, LiftWorkspace& workspace);
void raise_skin(const SkinRings& rings, std::span<const SkinPenetration> points,
                std::span<float> positions, LiftWorkspace& workspace);

}  // namespace ecorche::inline v1
