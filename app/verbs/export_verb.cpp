#include "app/verbs/export_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "anatomy/errors.h"
#include "anatomy/model_files/export_ground.h"
#include "anatomy/model_files/mjcf_writer.h"
#include "anatomy/model_files/model_export.h"
#include "anatomy/model_files/osim_writer.h"
#include "app/files/body_inertia.h"
#include "app/files/open_character.h"
#include "app/files/skin_markers.h"
#include "app/options/option_values.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct Options {
  fs::path character;
  std::vector<fs::path> outputs;
  bool no_meshes = false, ground = false;
  std::string masses = "tissues";
};

// The skin's landmarks, where it has them.
void mark(const Assets& assets, const Character& character, ExportModel& model, Report& report) {
  std::vector<std::string> names;
  Points places;
  try {
    const std::vector<SkinMarker> markers = skin_markers(assets, character);
    places.resize(markers.size(), 3);
    for (const SkinMarker& marker : markers) {
      places.row(names.size()) = character.body.skin.V.row(marker.vertex);
      names.push_back(marker.name);
    }
  } catch (const Error&) {
    names.clear();  // another skin, or no body package
  }
  add_markers(character.anatomy, names, places, model);
  report.set("export.markers", int(names.size()));
}

// Masses of the body's own tissues; the table's stay where its skin has no inside.
void weigh(const Common& common, const Character& character, ExportModel& model, Report& report) {
  try {
    set_masses(weigh_character(common.assets, character, report).segments, model);
  } catch (const UnfitError& e) {
    note(common, fmt::format("warning: {}; masses are those of `--masses table`", e.what()));
  }
}

int run_export(const Options& options, const Common& common, Report& report) {
  for (const fs::path& output : options.outputs) require_ending(output, {".osim", ".xml"});
  check_outputs(common, options.outputs, {options.character});
  const Character character = open_character(options.character, common, report);
  ExportModel model = make_export_model(character.anatomy, character.body, common.assets.tables);
  if (options.masses == "tissues") weigh(common, character, model, report);
  if (options.no_meshes) model.meshes.clear();
  if (options.ground) add_ground(character.anatomy, character.body, model);
  mark(common.assets, character, model, report);
  double mass = 0;
  for (const ExportBody& body : model.bodies) mass += body.mass;
  report.set("bones", int(character.anatomy.bones.size()));
  report.set("muscles", int(character.anatomy.muscles.size()));
  report.set("export.bodies", int(model.bodies.size()));
  report.set("export.coordinates", int(model.angles.size()));
  report.set("export.actuators", int(model.strips.size()));
  report.set("export.mass", mass);
  report.set("export.blended_points", model.blended_points);
  report.set("export.forces_of_filled_volumes", model.filled_forces);
  if (model.filled_forces > 0)
    note(common, fmt::format("warning: {} muscles do not say how strong they are, as in characters "
                             "of earlier versions; their forces are those of volumes that fill the "
                             "skin, which is too much. `ecorche fit` of the body writes them",
                             model.filled_forces));
  for (const fs::path& output : options.outputs) {
    const StageTimer timer(report, "write_" + output.extension().string().substr(1));
    const bool mujoco = output.extension() == ".xml";
    const ExportLosses losses = mujoco ? write_mjcf(output, model) : write_osim(output, model);
    if (mujoco) report.set("export.wraps_left_out", losses.wraps_left_out);
    if (mujoco) report.set("export.wraps_as_spheres", losses.wraps_as_spheres);
    note(common, fmt::format("{}: {} bodies, {} angles, {} actuators, {:.1f} kg", output.string(),
                             model.bodies.size(), model.angles.size(), model.strips.size(), mass));
    if (losses.wraps_as_spheres > 0)
      note(common, fmt::format("{} ellipsoids to wrap over, which MuJoCo has no word for, are "
                               "spheres like them where the muscle passes",
                               losses.wraps_as_spheres));
    if (losses.wraps_left_out > 0)
      note(common,
           fmt::format("{} objects to wrap over are left out: MuJoCo takes one between two points",
                       losses.wraps_left_out));
  }
  return 0;
}

}  // namespace

void add_export_verb(VerbRegistry& registry) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(registry, registry.app, "export",
                            "Write a character as a musculoskeletal model for OpenSim or MuJoCo",
                            "ecorche export anna-anatomy.glb -o anna.osim -o anna.xml",
                            [options](const Common& common, Report& report) {
                              return run_export(*options, common, report);
                            });
  verb->add_option("character", options->character,
                   "Character written by `ecorche fit`, CROWD.glb#NAME, or a template of `ecorche "
                   "template import`")
      ->required();
  verb->add_option("-o,--output", options->outputs,
                   "Model to write; may be given several times: .osim (OpenSim 4), .xml (MuJoCo). "
                   "Bones go to NAME_meshes beside it")
      ->required();
  verb->add_flag("--ground", options->ground,
                 "A floor, and balls under heels, edges, balls and toes of the feet that meet it, "
                 "so that the model can stand");
  verb->add_option(
          "--masses", options->masses,
          "Masses and inertias of bodies: tissues (what `ecorche inertia` finds), table (de "
          "Leva's for the sex, stature and mass)")
      ->check(one_of({"tissues", "table"}))
      ->capture_default_str();
  verb->add_flag("--no-meshes", options->no_meshes, "Do not write the bones");
}

}  // namespace ecorche
