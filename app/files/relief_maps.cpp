#include "app/files/relief_maps.h"

#include <cstddef>
#include <utility>

#include "anatomy/errors.h"
#include "app/files/actor.h"

namespace ecorche {
namespace {

Points points_of(const SkinFrame& skin) {
  Points out(Eigen::Index(skin.positions.size() / 4), 3);
  for (Eigen::Index v = 0; v < out.rows(); ++v)
    for (Eigen::Index k = 0; k < 3; ++k) out(v, k) = double(skin.positions[std::size_t(4 * v + k)]);
  return out;
}

}  // namespace

SkinMaps relief_maps(const Assets& assets, Character character, double definition, int size,
                     Report& report) {
  const Actor actor = make_actor(assets, std::move(character), report,
                                 {.muscles = MuscleMotion::lines,
                                  .definition = definition,
                                  .refinement = true,
                                  .texture = true});
  if (actor.corners.empty())
    throw UnfitError(
        "--maps: only skins of ours know where they lie on a texture, and show something at a "
        "--definition above 0; bake one made by `ecorche body new`");
  CharacterState state(actor);
  DetailedSkin skin;
  evaluate(actor, rest_pose(actor.character.anatomy.skeleton), {}, state);
  skin.detailed = points_of(state.skin);
  skin.smooth = {points_of(evaluate_posed_skin(actor.skin, {}, state)),
                 actor.character.body.skin.F};
  skin.corners = actor.corners;
  return skin_maps(skin, size);
}

}  // namespace ecorche
