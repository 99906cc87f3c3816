#include "app/verbs/export_verb.h"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/files/open_character.h"
#include "app/models/model_file.h"
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

int run_export(const Options& options, const Common& common, Report& report) {
  for (const fs::path& output : options.outputs) require_ending(output, {".osim", ".xml"});
  check_outputs(common, options.outputs, {options.character});
  const Character character = open_character(options.character, common, report);
  const ExportModel model = model_of(
      character, {options.masses == "tissues", !options.no_meshes, options.ground}, common, report);
  for (const fs::path& output : options.outputs) write_model_file(output, model, common, report);
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
