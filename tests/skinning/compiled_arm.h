// Arms compiled for tests, and their skin over muscles in any place.
#pragma once

#include "skinning/character/evaluate.h"
#include "tests/skinning/arm.h"

namespace ecorche::test {

inline CharacterModel compile_figure(const Anatomy& anatomy, const TriMesh& skin,
                                     const CompileOptions& options = {}) {
  Character character;
  character.anatomy = anatomy;
  character.body.skin = skin;
  return compile_character(std::move(character), options);
}

// The same, but muscles do not lift the skin.
inline CharacterModel compile_without_collision(const Anatomy& anatomy, const TriMesh& skin,
                                                const CompileOptions& options = {}) {
  CharacterModel model = compile_figure(anatomy, skin, options);
  model.skin.collision = {};
  return model;
}

inline SkinFrame skin_over(const CharacterModel& model, const PosedAnatomy& posed) {
  CharacterState state(model);
  state.posed = posed;
  return evaluate_posed_skin(model.skin, {}, state);
}

}  // namespace ecorche::test
