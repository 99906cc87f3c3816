#include "app/verbs/lift/sit_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>

#include "anatomy/errors.h"
#include "app/files/carried_actor.h"
#include "app/options/option_values.h"
#include "app/options/subject_options.h"
#include "app/verbs/lift/carried_options.h"
#include "skinning/lift/chair.h"
#include "skinning/lift/resting_pose.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

constexpr double kSitSeconds = 4;
constexpr double kStoolRecline = -10;  // degrees: without a back one leans over one's thighs
constexpr double kThickest = 0.12;     // m, of the tissue that counts: a thigh has more than others

struct SitVerbOptions : CarriedOptions {
  double foam_kpa = 40, step = 1.0 / 60;
  bool no_back = false, no_floor = false;
  ChairOptions chair;
};

// Along the seat from the peak to the nearer ischial tuberosity, the lowest of the hip bone, m.
double way_to_ischium(const CarriedActor& carried, const LiftResult& sat, int peak_vertex) {
  double out = 1e9;
  for (const char* bone : {"hip_bone_l", "hip_bone_r"}) {
    const Vec3 way = lowest_of_bone(carried.actor->character.anatomy, bone, sat.last.body.pose) -
                     sat.last.skin.row(peak_vertex).transpose();
    out = std::min(out, std::hypot(way.x(), way.z()));
  }
  return out;
}

// Thickness of the tissue below the lowest point of a bone, m.
double tissue_below(const CarriedActor& carried, const Pose& pose, const Points& skin,
                    const std::string& bone) {
  const Vec3 lowest = lowest_of_bone(carried.actor->character.anatomy, bone, pose);
  Eigen::Index at = 0;
  (skin.rowwise() - lowest.transpose()).rowwise().squaredNorm().minCoeff(&at);
  return carried.model.patient.thickness[std::size_t(at)];
}

int run_sit(SitVerbOptions options, const Common& common, Report& report) {
  set_picture(options);
  require_ending(options.film.output, {".mp4", ".png"});
  const bool numbered = options.film.output.string().find('%') != std::string::npos;
  check_outputs(common, {numbered ? fs::path() : options.film.output}, {options.character});
  options.chair.back = !options.no_back;
  options.chair.floor = !options.no_floor;
  options.chair.foam = 1e3 * options.foam_kpa;
  FleshOptions flesh = options.flesh();
  flesh.thickest = kThickest;
  CarriedActor carried = carried_actor(options.character, flesh, common, report);
  CarryModel& model = carried.model;
  model.mattress.present = false;
  model.options.step = options.step;
  const Pose sitting =
      sitting_pose(model.patient, options.chair.back ? options.chair.recline : kStoolRecline);
  Points skin;
  model.shaper(sitting, skin);
  measure_tissue(carried.actor->character.anatomy, sitting, skin, model.patient);
  report.set("sit.tissue_below_ischium_mm",
             1e3 * tissue_below(carried, sitting, skin, "hip_bone_l"));
  model.pads = make_chair(model.patient, skin, options.chair);
  keep_seated(options.chair.back, model.patient);
  const bool still = options.film.output.extension() == ".png" && !numbered;
  const LiftResult sat = rest_patient(model, sitting, kSitSeconds, still ? 0 : options.film.fps);
  report_pressure("sit", model, sat, report);
  const PressureFigures seat = pad_figures(model, sat, 0);
  const double way = seat.peak_vertex < 0 ? 0 : way_to_ischium(carried, sat, seat.peak_vertex);
  report.set("sit.peak_to_ischium_mm", 1e3 * way);
  film_lift(model, sat, options.film, common);
  print_regions(model, sat);
  note(common, fmt::format("seat {:.0f} N, peak {:.1f} kPa, {:.0f} mm from the ischial tuberosity; "
                           "{:.1f} N upwards on the skin of {:.1f} N of weight",
                           seat.force, seat.peak / 1e3, 1e3 * way,
                           report.number("sit.contact_force"), report.number("sit.weight")));
  return tell_missed_force("sit", kForceError, common, report);
}

}  // namespace

void add_sit_verb(VerbRegistry& registry) {
  auto options = std::make_shared<SitVerbOptions>();
  options->scale_kpa = 20;
  CLI::App* verb =
      add_verb(registry, registry.app, "sit",
               "Seat a person on a chair: film or picture, pressure on the skin, forces",
               "ecorche sit anna-anatomy.glb -o anna-sits.png --foam 25\n"
               "  ecorche sit anna-anatomy.glb -o anna-sits.mp4 --no-back",
               [options](const Common& common, Report& report) {
                 return run_sit(*options, common, report);
               });
  add_character_option(*verb, options->character);
  verb->add_option("-o,--output", options->film.output,
                   "FILM.mp4, numbered pictures DIR/%04d.png, or one picture STILL.png of the end")
      ->required();
  verb->add_option("--recline", options->chair.recline,
                   "Of the chair's back and the trunk, degrees from upright")
      ->check(between(0.0, 40.0))
      ->capture_default_str();
  CLI::Option* stool =
      verb->add_flag("--no-back", options->no_back, "A stool: the trunk keeps itself upright");
  verb->add_flag("--no-floor", options->no_floor,
                 "The feet hang; with a back alone, for on a stool one falls over")
      ->excludes(stool);
  verb->add_option("--foam", options->foam_kpa,
                   "Modulus of the cushions, kPa: 20 soft, 40 usual, 80 firm, 10000 wood")
      ->check(between(2.0, 10000.0))
      ->capture_default_str();
  verb->add_option("--foam-thickness", options->chair.thickness, "Of the cushions, m")
      ->check(between(0.005, 0.5))
      ->capture_default_str();
  add_step_option(*verb, options->step);
  add_tissue_option(*verb, *options);
  add_film_options(*verb, *options);
}

}  // namespace ecorche
