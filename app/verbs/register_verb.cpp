#include "app/verbs/register_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/files/input_file.h"
#include "anatomy/mesh_files/mesh_io.h"
#include "app/files/open_body.h"
#include "app/files/register_file.h"
#include "app/options/option_values.h"
#include "app/options/subject_options.h"
#include "app/pages/registration_page.h"
#include "app/progress.h"
#include "morph/measures/body_volume.h"
#include "skinning/files/character_write.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct RegisterOptions {
  fs::path scan, output, posed, page;
  RegisterFileOptions how;
};

// The registered skin in the pose and the coordinates of the scan's file.
TriMesh in_file(const Registration& found, const BodyPackage& package) {
  Points points = found.posed;
  points.rowwise() -= found.shift.transpose();
  return {points * found.axes / found.scale, package.triangles};
}

int run_register(const RegisterOptions& options, const Common& common, Report& report) {
  require_ending(options.output, {".glb"});
  if (!options.posed.empty()) require_ending(options.posed, {".ply", ".obj"});
  if (!options.page.empty()) require_ending(options.page, {".html"});
  check_outputs(common, {options.output, options.posed, options.page},
                {options.scan, options.how.landmarks});
  const std::string shown = printable(options.scan.string());
  Progress progress(common, "registration", 5);
  progress.at(0, "reading");
  const RegistrationModel model = make_registration_model(common.assets);
  RegisterFileOptions how = options.how;
  RegistrationStages stages;
  how.watch = [&](const std::string& stage, const Points& posed) {
    stages.emplace_back(stage, posed);
    progress.at(stage == "pose" ? 1 : stage == "shape" ? 2 : 3, stage.c_str());
  };
  RegisteredFile registered = register_file(options.scan, model, how, common, report);
  const Scan& scan = registered.scan;
  Registration& found = registered.registration;
  progress.at(4, "measuring");
  found.body.name = printable(options.output.stem().string());
  write_body(options.output, found.body);
  if (options.posed.extension() == ".obj")
    write_obj(options.posed, in_file(found, model.package));
  else if (!options.posed.empty())
    write_ply(options.posed, in_file(found, model.package));
  const RegistrationDistances distances = registration_distances(scan, found, model.package);
  const double height = stature(model.package, found.body.skin.V);
  report_registration(scan, found, distances, height, report);
  if (!options.page.empty())
    write_file_atomically(
        options.page, registration_page("Registration of " + shown, scan, found, distances, stages,
                                        model.package, height));
  progress.at(5);
  const RegistrationReport& figures = found.report;
  note(common,
       fmt::format("{}: {:.1f} cm, {:.0f} kg; scan to body median {:.1f} mm, 95 % below {:.1f} mm; "
                   "{:.0f} % of the skin was not seen",
                   options.output.string(), 100 * height, found.body.mass,
                   1e3 * figures.scan_to_body.median, 1e3 * figures.scan_to_body.p95,
                   100 * figures.unseen));
  for (const std::string& text : figures.doubts) note(common, "doubtful: " + text);
  return figures.doubts.empty() ? 0 : 8;
}

}  // namespace

void add_body_register(VerbRegistry& registry, CLI::App& body) {
  auto options = std::make_shared<RegisterOptions>();
  CLI::App* verb = add_verb(
      registry, body, "register", "Make a body of a scan, sculpt or character of any topology",
      "ecorche body register scan.ply -o body.glb --page scan.html\n  ecorche body register "
      "scan.obj --unit mm --pose A --stature 168cm -o body.glb --report scan.json",
      [options](const Common& common, Report& report) {
        return run_register(*options, common, report);
      });
  verb->add_option("scan", options->scan,
                   "A standing person's surface: a mesh or bare points (docs/scans.md has the "
                   "formats), in any unit, axes and place")
      ->required();
  add_body_output_option(*verb, options->output);
  add_registration_options(*verb, options->how);
  add_skin_unit_option(*verb, "--unit", options->how.unit);
  verb->add_option("--posed", options->posed,
                   "Write the registered skin in the scan's pose and coordinates as well, to lay "
                   "over it (.ply or .obj)");
  verb->add_option("--page", options->page,
                   "Write a page with pictures (.html): scan beside body, distances, worst places");
}

}  // namespace ecorche
