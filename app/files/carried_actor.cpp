#include "app/files/carried_actor.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "anatomy/errors.h"
#include "anatomy/geometry/mesh_measures.h"
#include "app/files/open_character.h"

namespace ecorche {
namespace {

constexpr double kInhaledDensity = 985;  // kg/m^3, of a body that has breathed in

}  // namespace

CarriedActor carried_actor(const std::filesystem::path& file, const FleshOptions& tissue,
                           const Common& common, Report& report) {
  CarriedActor out;
  auto actor =
      std::make_shared<Actor>(make_actor(common.assets, open_character(file, common, report),
                                         report, {.muscles = MuscleMotion::lines}));
  const Character& character = actor->character;
  const double mass = character.body.mass > 0
                          ? character.body.mass
                          : kInhaledDensity * std::abs(mesh_volume(character.body.skin));
  try {
    out.model.patient = make_patient(character.anatomy, character.body.skin,
                                     actor->binding.joint_weights, mass, tissue);
  } catch (const std::invalid_argument& e) {
    throw UnfitError(fmt::format("{}: {}; take a character that `ecorche fit` has made from a body",
                                 file.string(), e.what()));
  }
  auto state = std::make_shared<ActorState>(*actor);
  out.model.shaper = [actor, state](const Pose& pose, Points& skin) {
    to_points(evaluate_skin(*actor, pose, {}, *state), skin);
  };
  out.actor = std::move(actor);
  return out;
}

int tell_missed_force(const std::string& name, double share, const Common& common, Report& report) {
  const double weight = report.number(name + ".weight"),
               force = report.number(name + ".contact_force");
  if (std::abs(force - weight) <= share * weight) return 0;
  const std::string missed =
      fmt::format("contact forces add up to {:.1f} N; the weight is {:.1f} N", force, weight);
  note(common, "missed: " + missed);
  report.append_text("missed", missed);
  return 8;
}

}  // namespace ecorche
