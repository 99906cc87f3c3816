#include "app/models/model_file.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "anatomy/errors.h"
#include "anatomy/model_files/export_ground.h"
#include "anatomy/model_files/mjcf_writer.h"
#include "anatomy/model_files/osim_writer.h"
#include "app/files/body_inertia.h"
#include "app/files/skin_markers.h"

namespace ecorche {
namespace {

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

double mass_of(const ExportModel& model) {
  double mass = 0;
  for (const ExportBody& body : model.bodies) mass += body.mass;
  return mass;
}

void report_model(const Character& character, const ExportModel& model, Report& report) {
  report.set("bones", int(character.anatomy.bones.size()));
  report.set("muscles", int(character.anatomy.muscles.size()));
  report.set("export.bodies", int(model.bodies.size()));
  report.set("export.coordinates", int(model.angles.size()));
  report.set("export.actuators", int(model.strips.size()));
  report.set("export.mass", mass_of(model));
  report.set("export.blended_points", model.blended_points);
  report.set("export.forces_of_filled_volumes", model.filled_forces);
}

}  // namespace

ExportModel model_of(const Character& character, const ModelFileOptions& options,
                     const Common& common, Report& report) {
  ExportModel model = make_export_model(character.anatomy, character.body, common.assets.tables);
  if (options.weighed) weigh(common, character, model, report);
  if (!options.meshes) model.meshes.clear();
  if (options.ground) add_ground(character.anatomy, character.body, model);
  mark(common.assets, character, model, report);
  report_model(character, model, report);
  if (model.filled_forces > 0)
    note(common, fmt::format("warning: {} muscles do not say how strong they are, as in characters "
                             "of earlier versions; their forces are those of volumes that fill the "
                             "skin, which is too much. `ecorche fit` of the body writes them",
                             model.filled_forces));
  return model;
}

void write_model_file(const std::filesystem::path& file, const ExportModel& model,
                      const Common& common, Report& report) {
  const StageTimer timer(report, "write_" + file.extension().string().substr(1));
  const bool mujoco = file.extension() == ".xml";
  const ExportLosses losses = mujoco ? write_mjcf(file, model) : write_osim(file, model);
  if (mujoco) report.set("export.wraps_left_out", losses.wraps_left_out);
  if (mujoco) report.set("export.wraps_as_spheres", losses.wraps_as_spheres);
  note(common,
       fmt::format("{}: {} bodies, {} angles, {} actuators, {:.1f} kg", file.string(),
                   model.bodies.size(), model.angles.size(), model.strips.size(), mass_of(model)));
  if (losses.wraps_as_spheres > 0)
    note(common, fmt::format("{} ellipsoids to wrap over, which MuJoCo has no word for, are "
                             "spheres like them where the muscle passes",
                             losses.wraps_as_spheres));
  if (losses.wraps_left_out > 0)
    note(common,
         fmt::format("{} objects to wrap over are left out: MuJoCo takes one between two points",
                     losses.wraps_left_out));
}

}  // namespace ecorche
