#include "app/verbs/template/template_import.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "anatomy/files/input_file.h"
#include "anatomy/model_files/model_reader.h"
#include "anatomy/model_files/musculoskeletal_model.h"
#include "app/files/actor.h"
#include "app/options/option_values.h"
#include "morph/template/import_model.h"
#include "morph/template/template_cache.h"
#include "skinning/files/character_check.h"
#include "skinning/files/character_write.h"

namespace ecorche {
namespace {

constexpr int kShownNotes = 6;

struct Options {
  std::filesystem::path model, folder, output;
  double stress = 60;  // N/cm^2, as the literature states it
  bool mirror = false, own_bones = false;
};

void fill(const Imported& imported, Report& report) {
  const ImportReport& r = imported.report;
  report.set("bones", int(imported.anatomy.bones.size()));
  report.set("muscles", r.muscles);
  report.set("strips", r.strips);
  report.set("slices", slice_count(imported.anatomy));
  report.set("muscle_volume", r.volume);
  report.set("import.bodies", int(r.match.bodies.size()));
  report.set("import.bodies_named", int(std::count_if(r.match.bodies.begin(), r.match.bodies.end(),
                                                      [](const BodyMatch& b) { return b.named; })));
  report.set("import.same_skeleton", r.match.same ? 1 : 0);
  report.set("import.posture_difference", r.match.direction_error);
  report.set("import.joint_centre_error", r.match.center_error);
  report.set("import.path_points", r.points);
  report.set("import.via_points_added", r.via_points);
  report.set("import.wraps", r.wraps);
  report.set("import.forces_unknown", r.forces_unknown);
  report.set("import.meshes", r.meshes);
  report.set("import.meshes_missing", r.meshes_missing);
  report.set("import.attachment_distance_median", r.attachment_median);
  report.set("import.attachment_distance_max", r.attachment_max);
  report.set("import.attachment_distance_muscle", r.attachment_worst);
}

int run_import(const Options& options, const Common& common, Report& report) {
  require_ending(options.output, {".glb"});
  check_outputs(common, {options.output}, {options.model});
  const std::filesystem::path folder = options.folder.empty()
                                           ? std::filesystem::absolute(options.model).parent_path()
                                           : options.folder;
  MusculoskeletalModel model;
  {
    const StageTimer timer(report, "read_model");
    model = read_muscle_model(options.model, folder);
  }
  const Template base = read_template(common.assets);
  ImportOptions import;
  import.stress = 1e4 * options.stress;
  import.mirror = options.mirror;
  if (!options.own_bones) import.folder = folder;
  Imported imported;
  {
    const StageTimer timer(report, "import_model");
    imported = import_model(model, base, common.assets, import);
  }
  fill(imported, report);
  const ImportReport& r = imported.report;
  Body body = base.body;
  body.name = model.name.empty() ? options.model.stem().string() : model.name;
  body.name = printable(body.name);
  Character character{imported.anatomy, std::move(body)};
  check_character(character, printable(options.model.string()));
  const BoundCharacter bound = bind_character(common.assets, std::move(character), report);
  const CharacterLook look =
      find_look(common.assets, bound.character.body.skin, bound.character.anatomy.skeleton);
  write_character(options.output, bound.character, bound.binding, nullptr, look);

  note(common, fmt::format("{}: {} of {} muscles, {} bones, {:.1f} l of muscle; ends {:.1f} mm "
                           "from bones (median), {:.0f} mm at most ({})",
                           options.output.string(), r.muscles, model.muscles.size(),
                           imported.anatomy.bones.size(), 1e3 * r.volume, 1e3 * r.attachment_median,
                           1e3 * r.attachment_max, r.attachment_worst));
  note(common, r.match.same
                   ? fmt::format("the model's skeleton is the {}",
                                 r.upright ? "bone package's own" : "default body's own")
                   : fmt::format("posture differs by {:.0f} degrees (rms); joint centres agree to "
                                 "{:.0f} mm once each body is turned and scaled",
                                 r.match.direction_error * 57.29578, 1e3 * r.match.center_error));
  std::string unknown;
  for (const std::string& name : r.match.unknown) unknown += (unknown.empty() ? "" : ", ") + name;
  if (!unknown.empty())
    note(common, "bodies that go with their parents (data/model_bodies.csv does not name them): " +
                     unknown);
  if (r.forces_unknown > 0)
    note(common,
         fmt::format("{} muscles without force or fibre length: drawn with 1 cm2 of section",
                     r.forces_unknown));
  if (r.meshes_missing > 0)
    note(common, fmt::format("{} of the model's meshes are not beside it: our own bones stand in",
                             r.meshes_missing));
  for (size_t k = 0; k < r.notes.size() && (common.verbose || k < kShownNotes); ++k)
    note(common, r.notes[k]);
  if (!common.verbose && r.notes.size() > kShownNotes)
    note(common, fmt::format("and {} more notes; -v shows them", r.notes.size() - kShownNotes));
  return 0;
}

}  // namespace

void add_template_import(VerbRegistry& registry, CLI::App& template_verb) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(
      registry, template_verb, "import",
      "Make a template of an OpenSim (.osim) or MuJoCo (.xml) model",
      "ecorche template import gait.osim -o gait.glb\n  ecorche fit anna.glb --template gait.glb "
      "-o anna-gait.glb\n"
      "  ecorche template import model/body/myofullbody.xml --folder model -o myo.glb",
      [options](const Common& common, Report& report) {
        return run_import(*options, common, report);
      });
  verb->add_option("model", options->model, "OpenSim 3 or 4 model, or MJCF file")->required();
  verb->add_option("-o,--output", options->output,
                   "Template to write (.glb); any glTF viewer and `ecorche view` open it")
      ->required();
  verb->add_option("--folder", options->folder,
                   "Folder that holds all files of the model; that of MODEL when left out. Nothing "
                   "outside it is read");
  verb->add_option("--stress", options->stress,
                   "Force per cross-section that the model's forces stand for, N/cm2; sets the "
                   "muscles' volumes")
      ->check(between(5.0, 200.0))
      ->capture_default_str();
  verb->add_flag("--mirror", options->mirror,
                 "Add the other side of muscles that the model has on one side only");
  verb->add_flag("--our-bones", options->own_bones,
                 "Do not read the model's meshes; show our bones");
}

}  // namespace ecorche
