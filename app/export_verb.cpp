// ecorche export: a character as a musculoskeletal model for OpenSim or MuJoCo.
#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/export_model.h"
#include "app/open_character.h"
#include "app/verb.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct Options {
  fs::path character;
  std::vector<fs::path> outputs;
  bool no_meshes = false;
};

int run(const Options& options, const Common& common, Report& report) {
  for (const fs::path& output : options.outputs) require_ending(output, {".osim", ".xml"});
  check_outputs(common, options.outputs, {options.character});
  const Character character = open_character(options.character, common, report);
  ExportModel model = make_export_model(character.anatomy, character.body);
  if (options.no_meshes) model.meshes.clear();
  double mass = 0;
  for (const ExportBody& body : model.bodies) mass += body.mass;
  report.set("bones", static_cast<int>(character.anatomy.bones.size()));
  report.set("muscles", static_cast<int>(character.anatomy.muscles.size()));
  report.set("export.bodies", static_cast<int>(model.bodies.size()));
  report.set("export.coordinates", static_cast<int>(model.angles.size()));
  report.set("export.actuators", static_cast<int>(model.strips.size()));
  report.set("export.mass", mass);
  report.set("export.blended_points", model.blended_points);
  for (const fs::path& output : options.outputs) {
    const StageTimer timer(report, "write_" + output.extension().string().substr(1));
    const int left_out = output.extension() == ".osim" ? write_osim(output, model) : write_mjcf(output, model);
    if (output.extension() == ".xml") report.set("export.wraps_left_out", left_out);
    note(common, fmt::format("{}: {} bodies, {} angles, {} actuators, {:.1f} kg", output.string(), model.bodies.size(), model.angles.size(), model.strips.size(), mass));
    if (left_out > 0) note(common, fmt::format("{} wrap objects that MuJoCo has no word for (ellipsoids, a second one between two points) are left out", left_out));
  }
  return 0;
}

}  // namespace

void add_export_verb(VerbRegistry& registry) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(registry, registry.app, "export", "Write a character as a musculoskeletal model for OpenSim or MuJoCo",
                            "ecorche export anna-anatomy.glb -o anna.osim -o anna.xml",
                            [options](const Common& common, Report& report) { return run(*options, common, report); });
  verb->add_option("character", options->character, "Character written by `ecorche fit`, CROWD.glb#NAME, or a template of `ecorche template import`")->required();
  verb->add_option("-o,--output", options->outputs, "Model to write; may be given several times: .osim (OpenSim 4), .xml (MuJoCo). Bones go to NAME_meshes beside it")->required();
  verb->add_flag("--no-meshes", options->no_meshes, "Do not write the bones");
}

}  // namespace ecorche
