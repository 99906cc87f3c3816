#include "app/studio/bodies/posed_body.h"

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <utility>

#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/posing/pose_anatomy.h"
#include "app/edit/trial_pose.h"

namespace ecorche {

TriedFrame tried_frame(Workshop& workshop, const Document& document, const ShownBody& body,
                       int frame) {
  const Motion& motion = *body.motion;
  const int last = int(motion.frames.size()) - 1, at = std::clamp(frame, 0, last);
  const Pose& pose = motion.frames[std::size_t(at)];
  if (!body.actor) return {pose, {}};
  const Anatomy& anatomy = body.character().anatomy;
  return {trial_pose(workshop, document, anatomy.skeleton, pose),
          trial_activation(document, anatomy, last > 0 ? double(at) / motion.fps : 0)};
}

void stand(const Character& character, PosedAnatomy& posed, SkinFrame& skin) {
  const Anatomy& anatomy = character.anatomy;
  forward_kinematics(anatomy.skeleton, rest_pose(anatomy.skeleton), posed.X_WJ);
  posed.slices = rest_slices(anatomy);
  posed.lengths.clear();
  for (const Muscle& muscle : anatomy.muscles)
    for (const Strip& strip : muscle.strips) posed.lengths.push_back(strip.rest_length);
  to_frame(character.body.skin.V, vertex_normals(character.body.skin), skin);
}

void evaluate_tried(const Actor& actor, const TriedFrame& frame, bool quick, ActorState& state,
                    PosedAnatomy& posed, SkinFrame& skin) {
  std::swap(state.posed, posed);
  std::swap(state.skin, skin);
  if (quick) {
    pose_muscles(actor.muscles, actor.character.anatomy.skeleton, frame.pose, state.posed,
                 state.contact, tbb::this_task_arena::max_concurrency(), frame.efforts);
    evaluate_posed_skin(actor, SkinMethod::anchors, state);
  } else {
    evaluate(actor, frame.pose, {frame.efforts, {}}, state);
  }
  std::swap(state.posed, posed);
  std::swap(state.skin, skin);
}

}  // namespace ecorche
