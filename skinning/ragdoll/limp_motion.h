// Limbs that hang limp in a motion that goes on: damped pendulums, driven by what holds them.
//
// The rest of the body moves as the motion says and feels nothing of them. Limp joints resist like
// relaxed ones (ragdoll.h), stay within their limits, and keep out of the ground and of the body.
#pragma once

#include <string>
#include <vector>

#include "skinning/ragdoll/ragdoll_step.h"

namespace ecorche::inline v1 {

struct LimpResult {
  Motion motion;
  std::vector<std::string> joints;  // that swing
  double limit_excess = 0;          // rad, of any of them at any frame
  double overlap = 0;               // m, of limbs, beyond what tissue yields
};

// `limp`: joints that let go, with all below them. `ragdoll`: without driven joints, its groups all
// that a body has. The step is the longest. Throws std::invalid_argument for the root, or a joint
// at and below which nothing swings. Precondition: the motion has frames.
LimpResult limp_motion(Ragdoll ragdoll, const Motion& motion, const std::vector<std::string>& limp,
                       const RagdollOptions& options);

}  // namespace ecorche::inline v1
