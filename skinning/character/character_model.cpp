#include "skinning/character/character_model.h"

#include <chrono>
#include <utility>

#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/same_muscle.h"
#include "skinning/bind/bind.h"

namespace ecorche::inline v1 {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace

CharacterModel compile_character(Character character, const CompileOptions& options) {
  const Clock::time_point start = Clock::now();
  CharacterModel out;
  out.character = std::move(character);
  const Anatomy& anatomy = out.character.anatomy;
  const TriMesh& skin = out.character.body.skin;
  const CharacterModel* before = options.before;
  out.muscles = make_muscle_model(
      anatomy, before ? ContactBefore{&before->character.anatomy, &before->muscles.contact}
                      : ContactBefore{});
  PosedAnatomy rest;
  ContactWorkspace contact;
  pose_muscles(out.muscles, anatomy.skeleton, rest_pose(anatomy.skeleton), rest, contact);
  if (options.times) options.times->muscles_ms = milliseconds_since(start);
  const Clock::time_point bind_start = Clock::now();
  if (options.base) {
    const auto& [base, refinement] = *options.base;
    BoundRefinedSkin bound =
        bind_refined_skin(anatomy, rest, base, refinement, skin, options.bind, options.painted);
    out.skin = make_refined_skin_model(anatomy, rest, base, refinement, bound,
                                       before ? &before->skin : nullptr);
    out.binding = std::move(bound.binding);
  } else {
    BoundSkin bound = bind_skin(anatomy, rest, skin, options.bind, options.painted);
    out.skin = make_skin_model(anatomy, rest, skin, bound, before ? &before->skin : nullptr);
    out.binding = std::move(bound.binding);
  }
  if (options.muscles == MuscleMotion::map)
    out.interior = std::make_shared<const BodyMap>(make_body_map(
        anatomy, options.base ? options.base->mesh : skin, out.skin.base_blend->mesh.order, rest,
        before ? BodyMapBefore{before->interior.get(),
                               shared_sections(anatomy, before->character.anatomy).before}
               : BodyMapBefore{}));
  if (options.base)
    out.relief = make_skin_relief(
        anatomy, rest,
        {skin, options.base->mesh, options.base->refinement, out.binding.joint_weights},
        {.definition = options.definition, .layer = options.layer, .veins = options.veins});
  if (options.times) options.times->skin_ms = milliseconds_since(bind_start);
  return out;
}

Binding bind_for_export(const Character& character, const CompileOptions& options) {
  const Anatomy& anatomy = character.anatomy;
  PosedAnatomy rest;
  forward_kinematics(anatomy.skeleton, rest_pose(anatomy.skeleton), rest.X_WJ);
  rest.slices = rest_slices(anatomy);
  const Clock::time_point start = Clock::now();
  Binding out =
      options.base
          ? bind_for_export(anatomy, rest, options.base->mesh, options.base->refinement,
                            character.body.skin, options.bind, options.painted)
          : bind_for_export(anatomy, rest, character.body.skin, options.bind, options.painted);
  if (options.times) options.times->skin_ms = milliseconds_since(start);
  return out;
}

}  // namespace ecorche::inline v1
