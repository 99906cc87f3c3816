#include "app/verbs/lift/lie_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "anatomy/errors.h"
#include "app/files/carried_actor.h"
#include "app/options/option_values.h"
#include "app/options/subject_options.h"
#include "app/verbs/lift/carried_options.h"
#include "skinning/lift/resting_pose.h"

namespace ecorche {
namespace {

constexpr double kRestSeconds = 4;

struct LieVerbOptions : CarriedOptions {
  double foam_kpa = 40, thickness = 0.1;
};

int run_lie(LieVerbOptions options, const Common& common, Report& report) {
  set_picture(options);
  require_ending(options.film.output, {".png"});
  check_outputs(common, {options.film.output}, {options.character});
  CarriedActor carried = carried_actor(options.character, options.flesh(), common, report);
  CarryModel& model = carried.model;
  model.mattress.stiffness = 1e3 * options.foam_kpa / options.thickness;
  model.mattress.bottom = 0.8 * options.thickness;
  const LiftResult rest = rest_patient(model, lying_pose(model.patient), kRestSeconds);
  report_pressure("lie", model, rest, report);
  film_lift(model, rest, options.film, common);
  print_regions(model, rest);
  note(common, fmt::format("{:.1f} N on the skin of {:.1f} N of weight",
                           report.number("lie.contact_force"), report.number("lie.weight")));
  return tell_missed_force("lie", kForceError, common, report);
}

}  // namespace

void add_lie_verb(VerbRegistry& registry) {
  auto options = std::make_shared<LieVerbOptions>();
  CLI::App* verb = add_verb(registry, registry.app, "lie",
                            "Lay a person on a mattress: picture, pressure on the skin, forces",
                            "ecorche lie anna-anatomy.glb -o anna-lies.png --foam 25",
                            [options](const Common& common, Report& report) {
                              return run_lie(*options, common, report);
                            });
  add_character_option(*verb, options->character);
  verb->add_option("-o,--output", options->film.output, "PICTURE.png")->required();
  verb->add_option("--foam", options->foam_kpa,
                   "Modulus of the mattress, kPa: 20 soft, 40 usual, 80 firm")
      ->check(between(2.0, 10000.0))
      ->capture_default_str();
  verb->add_option("--foam-thickness", options->thickness, "Of the mattress, m")
      ->check(between(0.02, 0.5))
      ->capture_default_str();
  add_tissue_option(*verb, *options);
  add_picture_options(*verb, *options);
}

}  // namespace ecorche
