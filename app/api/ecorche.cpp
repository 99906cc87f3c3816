#include "app/api/ecorche.h"

#include <utility>

#include "skinning/files/character_look.h"

namespace ecorche::inline v1 {

const char* version() { return ECORCHE_VERSION; }

Body make_body(const Assets& assets, const BodySpec& spec) {
  return make_body(BodyModel(assets), spec);
}

FittedCharacter fit_character(const Assets& assets, const Template& body_template, const Body& body,
                              const FittingOptions& options) {
  return fit_character(body_template, body, read_body_package(assets), options);
}

CharacterModel compile(const FittedCharacter& fitted, const Body& body) {
  return compile_character({fitted.anatomy, body}, {.muscles = MuscleMotion::map});
}

Retargeted retarget(const MotionClip& clip, const Character& character, RetargetOptions options) {
  measure_body(character.anatomy.skeleton, character.body.skin.V, options);
  Retargeted out;
  out.motion = retarget(clip, character.anatomy.skeleton, options, out.report);
  return out;
}

void write_character(const Assets& assets, const std::filesystem::path& file,
                     const CharacterModel& model, const Motion* motion, const ClipShapes* shapes) {
  const Character& character = model.character;
  write_character(file, character, model.binding, motion,
                  find_look(assets, character.body.skin, character.anatomy.skeleton), shapes);
}

}  // namespace ecorche::inline v1
