// A body that is shown, in a frame of its motion and the trial of a document.
#pragma once

#include <vector>

#include "app/edit/document/workshop.h"
#include "app/files/actor.h"
#include "app/studio/bodies/background_fit.h"

namespace ecorche {

// Pose and effort of each muscle in a frame; frames beyond the motion are its last.
struct TriedFrame {
  Pose pose;
  std::vector<double> efforts;
};
// The motion's pose alone, relaxed, for a body that is not bound. Throws as trial_pose.
TriedFrame tried_frame(Workshop& workshop, const Document& document, const ShownBody& body,
                       int frame);

// Joints, muscles and skin of a body that is not bound: at rest.
void stand(const Character& character, PosedAnatomy& posed, SkinFrame& skin);
// Of one that is. quick: the skin is blended over the muscles and does not settle, nor do muscles
// give way to it.
void evaluate_tried(const Actor& actor, const TriedFrame& frame, bool quick, ActorState& state,
                    PosedAnatomy& posed, SkinFrame& skin);

}  // namespace ecorche
