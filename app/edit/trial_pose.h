// What a document is tried in, on a character: pose and activation.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"
#include "app/edit/document/workshop.h"
#include "skinning/motion/activation.h"

namespace ecorche {

// The document's pose of the pose book (`start` where there is none, or a motion is played) with
// the joints that were turned.
Pose trial_pose(Workshop& workshop, const Document& document, const Skeleton& skeleton,
                const Pose& start);

// Efforts over the motion's time; of muscles that are named twice the later name counts.
Activations trial_activations(const Document& document, const Anatomy& anatomy);
// One value a muscle, at a moment.
std::vector<double> trial_activation(const Document& document, const Anatomy& anatomy,
                                     double seconds);

}  // namespace ecorche
