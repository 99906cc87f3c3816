// All memory of one frame of a character: results, values that one stage hands to the next, and
// workspaces. One a thread; a copy is independent of the original.
#pragma once

#include <vector>

#include "anatomy/contact/muscle_contact.h"
#include "anatomy/posed_anatomy.h"
#include "anatomy/posing/restore_volume.h"
#include "skinning/bind/blend_skin.h"
#include "skinning/character/character_model.h"
#include "skinning/muscle_collision/collision_workspace.h"
#include "skinning/muscle_collision/lift_skin_over_muscles.h"
#include "skinning/relaxed_skin.h"
#include "skinning/relief/skin_relief.h"
#include "skinning/settle/settle_workspace.h"
#include "skinning/skin_frame.h"

namespace ecorche::inline v1 {

struct CharacterState {
  // Sized for the model; other buffers are sized by the first frame.
  explicit CharacterState(const CharacterModel& model);

  // Results.
  PosedAnatomy posed;
  SkinFrame skin;

  // From stage to stage.
  BlendPose blend;      // frames and handle offsets
  RelaxedSkin relaxed;  // the mesh that relaxes
  SkinLift lift;

  // Workspaces: no meaning between calls.
  SkinFrame sorted;  // a refined skin in its sorted order
  ContactWorkspace contact;
  SettleWorkspace settle;
  LiftWorkspace lifting;
  PushWorkspace push;
  BodyMapWorkspace carrying;
  VolumeWorkspace volumes;
  ReliefWorkspace relief;
};

}  // namespace ecorche::inline v1
