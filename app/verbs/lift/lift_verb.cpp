#include "app/verbs/lift/lift_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <optional>
#include <stdexcept>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/mesh_files/mesh_io.h"
#include "app/files/carried_actor.h"
#include "app/options/option_values.h"
#include "app/options/subject_options.h"
#include "app/progress.h"
#include "app/verbs/lift/carried_options.h"
#include "skinning/lift/resting_pose.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

constexpr double kLeastSide = 0.3, kMostSide = 5;  // m, of a sheet
constexpr Eigen::Index kMostNodes = 20000;

struct LiftVerbOptions : CarriedOptions {
  fs::path sling, table;
  std::string straps = "4";
  double step = 1.0 / 60;
  SlingOptions sheet;
};

// The sheet of a file in the plane of its two longest sides.
TriMesh read_sling(const fs::path& file) {
  TriMesh mesh = read_mesh(file);
  const Vec3 sides = (mesh.V.colwise().maxCoeff() - mesh.V.colwise().minCoeff()).transpose();
  if (std::min(sides.x(), sides.z()) < kLeastSide || std::max(sides.x(), sides.z()) > kMostSide)
    throw UnfitError(fmt::format(
        "{}: the sheet is {:.3g} m across (x) and {:.3g} m long (z); a sheet laid out flat, in "
        "metres, of {:g} to {:g} m is needed",
        file.string(), sides.x(), sides.z(), kLeastSide, kMostSide));
  if (mesh.V.rows() > kMostNodes)
    throw LimitError(
        fmt::format("{}: {} nodes; a sheet may have {}", file.string(), mesh.V.rows(), kMostNodes));
  return mesh;
}

// `cloth`: of the file; null: our rectangle.
Sheet sling_of(const LiftVerbOptions& options, const TriMesh* cloth, const Patient& patient,
               const Pose& lying) {
  if (!cloth) return make_sling(patient, lying, options.sheet);
  try {
    return make_sling(patient, lying, *cloth, options.sheet);
  } catch (const std::invalid_argument& e) {
    throw UnfitError(fmt::format("{}: {}; clean the mesh", options.sling.string(), e.what()));
  }
}

void check_options_lift(const LiftVerbOptions& options) {
  if (options.film.output.empty() && options.table.empty())
    throw UsageError("lift: nothing to do; give -o FILM.mp4, -o STILL.png or --table FILE.csv");
  if (!options.film.output.empty()) require_ending(options.film.output, {".mp4", ".png"});
  if (!options.table.empty()) require_ending(options.table, {".csv"});
}

int run_lift(LiftVerbOptions options, const Common& common, Report& report) {
  set_picture(options);
  check_options_lift(options);
  options.sheet.straps = options.straps == "6" ? 6 : 4;
  const bool numbered = options.film.output.string().find('%') != std::string::npos;
  check_outputs(common, {numbered ? fs::path() : options.film.output, options.table},
                {options.character, options.sling});
  std::optional<TriMesh> cloth;
  if (!options.sling.empty()) cloth = read_sling(options.sling);
  CarriedActor carried = carried_actor(options.character, options.flesh(), common, report);
  CarryModel& model = carried.model;
  model.options.step = options.step;
  const Pose lying = lying_pose(model.patient);
  model.sheet =
      std::make_shared<Sheet>(sling_of(options, cloth ? &*cloth : nullptr, model.patient, lying));
  LiftOptions course;
  course.frames_per_second = options.film.fps;
  LiftResult lift;
  {
    Progress progress(common, "lift", 100);
    lift = lift_patient(model, lying, course, [&](double share) { progress.at(int(100 * share)); });
  }
  report_pressure("lift", model, lift, report);
  if (!options.table.empty()) write_force_table(options.table, model, lift);
  if (!options.film.output.empty()) {
    const FilmReport done = film_lift(model, lift, options.film, common);
    report.set("timings_ms.film", 1e3 * done.seconds);
    report.set("film.frames", done.frames);
  }
  print_regions(model, lift);
  note(
      common,
      fmt::format("{:.1f} s of {} nodes in {:.1f} s ({:.1f} times real time); {:.1f} N on the skin "
                  "of {:.1f} N, {:.1f} N in the straps",
                  lift.last.time, model.sheet->mesh.V.rows(), lift.seconds,
                  report.number("lift.times_real_time"), report.number("lift.contact_force"),
                  report.number("lift.weight"), report.number("lift.strap_force")));
  const int code = tell_missed_force("lift", kForceError, common, report);
  const double mattress = report.number("lift.mattress_force");
  if (mattress <= kForceError * report.number("lift.weight")) return code;
  const std::string missed = fmt::format(
      "the person does not hang free: {:.1f} N are still on the mattress; take another sheet",
      mattress);
  note(common, "missed: " + missed);
  report.append_text("missed", missed);
  return 8;
}

}  // namespace

void add_lift_verb(VerbRegistry& registry) {
  auto options = std::make_shared<LiftVerbOptions>();
  CLI::App* verb = add_verb(registry, registry.app, "lift",
                            "Lift a person in a patient sling: film, pressure on the skin, forces",
                            "ecorche lift anna-anatomy.glb -o anna-lift.mp4 --table anna-lift.csv\n"
                            "  ecorche lift anna-anatomy.glb --straps 6 -o anna-hangs.png",
                            [options](const Common& common, Report& report) {
                              return run_lift(*options, common, report);
                            });
  add_character_option(*verb, options->character);
  verb->add_option("-o,--output", options->film.output,
                   "FILM.mp4, numbered pictures DIR/%04d.png, or one picture STILL.png of the end");
  verb->add_option("--table", options->table,
                   "FILE.csv: forces by region, of straps and mattress, and the peak, over time");
  verb->add_option("--sling", options->sling,
                   "A sheet (.obj, .ply), laid out flat: x across, z from the head to the feet, "
                   "metres; straps go to its outermost corners. Left away: a rectangle from the "
                   "head to below the knees");
  verb->add_option("--straps", options->straps, "4 at the corners; 6: two more beside the hips")
      ->check(one_of({"4", "6"}))
      ->capture_default_str();
  verb->add_option("--spacing", options->sheet.spacing,
                   "Metres between nodes of the rectangle; half of it takes some eight times as "
                   "long")
      ->check(between(0.015, 0.2))
      ->capture_default_str();
  add_step_option(*verb, options->step);
  add_tissue_option(*verb, *options);
  add_film_options(*verb, *options);
}

}  // namespace ecorche
