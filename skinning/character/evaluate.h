// Evaluates a frame of a character: joints, muscles, contact, skin, normals. A function of pose and
// inputs alone; same input, same bytes, at any number of threads. Nothing is allocated once a state
// has seen a few frames.
#pragma once

#include <span>

#include "anatomy/skeleton.h"
#include "skinning/character/character_model.h"
#include "skinning/character/character_state.h"

namespace ecorche::inline v1 {

struct FrameInputs {
  std::span<const double> activation{};  // per muscle, 0 relaxed .. 1; empty: all relaxed
  // Offsets of the mesh that relaxes by soft tissue that lags, SoftTissueState::offsets; empty:
  // none.
  std::span<const float> soft_tissue{};
};

// Fills state.posed and state.skin. Throws as pose_anatomy().
void evaluate(const CharacterModel& model, const Pose& pose, const FrameInputs& inputs,
              CharacterState& state);

// The same skin in half the time, for callers that look at the skin only: muscles that still
// protrude are not pushed below it, unless they make relief. Returns state.skin.
const SkinFrame& evaluate_skin(const CharacterModel& model, const Pose& pose,
                               const FrameInputs& inputs, CharacterState& state);

// The skin over the muscles in state.posed, however they have come there, without relief. Returns
// state.skin.
// Throws std::invalid_argument for a pose with other numbers of joints or slices than the model.
const SkinFrame& evaluate_posed_skin(const SkinModel& model, std::span<const float> soft_tissue,
                                     CharacterState& state);

// The skin as the blend alone places it over the muscles in state.posed: some ten times faster,
// without preserved volumes and contact. Returns state.skin. Throws as above.
const SkinFrame& evaluate_blended_skin(const SkinModel& model, CharacterState& state);

}  // namespace ecorche::inline v1
