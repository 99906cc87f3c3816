// The frames that skin vertices blend, in a pose. Private to the library.
#pragma once

#include <span>
#include <vector>

#include "skinning/bind/blend_tables.h"

namespace ecorche::inline v1 {

// The blend frames of one pose, and the memory they are made in. Sized on first use.
struct FrameWorkspace {
  std::vector<Transform> joints;  // #joints + #twists + #slides, these not rigid
  std::vector<Quat> rotations;    // of the same; of a slide its limb's
  // 16 floats a blend frame, four columns of four, relative to the root: from rest minus the root's
  // rest origin to posed minus its posed origin, so that floats stay exact far from the world's
  // origin
  std::vector<float> maps;
};

// Rotations of joints, twist and slide frames as quaternions whose signs follow the chain: each
// joint turns against its parent by a swing and a twist about its long axis, both by the shorter
// arc. A raised arm may have turned more than half a circle against the chest (girdle, shoulder and
// twist add up); the way between them then is the way the joints went, not the shorter one round
// the other side, and does not jump when the sum passes half a circle.
void chain_rotations(const FrameTables& tables, std::span<const Transform> X_WJ,
                     std::vector<Quat>& rotations);

// Fills `frames`. Precondition: X_WJ has #joints entries.
void pose_blend_frames(const FrameTables& tables, std::span<const Transform> X_WJ,
                       FrameWorkspace& frames);

}  // namespace ecorche::inline v1
