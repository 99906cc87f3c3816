#include "app/verbs/check_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/files/similar_names.h"
#include "app/files/actor.h"
#include "app/files/open_character.h"
#include "app/options/motion_options.h"
#include "app/pages/check_figures.h"
#include "app/pages/check_page.h"
#include "app/progress.h"
#include "morph/template/template.h"
#include "morph/template/template_cache.h"
#include "skinning/checks/bodies_check.h"
#include "skinning/checks/bulges.h"
#include "skinning/checks/check_targets.h"
#include "skinning/motion/pose_table.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct CheckVerbOptions {
  std::string character = "template", poses, muscles = "auto";
  std::vector<std::string> bodies;  // names; empty: all
  fs::path folder;
  bool no_pictures = false, no_sweeps = false;
};

// A bar that begins with the first step.
CheckProgress progress_of(const Common& common, const char* what) {
  auto bar = std::make_shared<std::optional<Progress>>();
  return [&common, what, bar](int done, int total) {
    if (done == 0)
      bar->emplace(common, what, total);
    else
      (*bar)->step();
  };
}

Character open_subject(const std::string& name, const Common& common, Report& report) {
  if (name != "template") return open_character(name, common, report);
  Template shown = read_template(common.assets);
  return {std::move(shown.anatomy), std::move(shown.body)};
}

std::vector<std::string> names_of(const std::vector<BodySpec>& bodies) {
  std::vector<std::string> out;
  for (const BodySpec& body : bodies) out.push_back(body.name);
  return out;
}

// One row per body; posed only if a table of poses was given.
int run_bodies(const CheckVerbOptions& options, const Common& common, Report& report) {
  std::vector<BodySpec> bodies = checked_bodies();
  for (const std::string& name : options.bodies)
    if (std::none_of(bodies.begin(), bodies.end(),
                     [&](const BodySpec& body) { return body.name == name; }))
      throw UsageError(
          fmt::format("--body {}: no such body{}\nLeave --body out to see their names.", name,
                      did_you_mean(name, names_of(bodies))));
  if (!options.bodies.empty())
    std::erase_if(bodies, [&](const BodySpec& body) {
      return std::find(options.bodies.begin(), options.bodies.end(), body.name) ==
             options.bodies.end();
    });
  std::vector<LimitPose> poses;
  if (!options.poses.empty() && options.poses != "none")
    poses = read_check_poses(options.poses, read_template(common.assets).anatomy.skeleton);
  const std::vector<BodyCheck> checks =
      check_bodies(common.assets, bodies, poses, progress_of(common, "bodies"));
  std::fputs(bodies_table(checks).c_str(), stdout);
  const auto met = std::count_if(checks.begin(), checks.end(), is_met);
  report.set("check.bodies", int(checks.size()));
  report.set("check.bodies_met", int(met));
  const bool all = met == long(checks.size());
  if (!options.folder.empty()) {
    write_file_atomically(options.folder / "bodies.csv", bodies_csv(checks));
    report.set("exit_code", all ? 0 : 8);
    report.write(options.folder / "check.json");
  }
  return all ? 0 : 8;
}

// Refuses options that would have no effect.
void check_options(const CheckVerbOptions& options, const Common& common) {
  const bool bodies = options.character == "bodies";
  if (!bodies && !options.bodies.empty())
    throw UsageError("--body: only with `ecorche check bodies`");
  if (bodies && (options.no_sweeps || options.no_pictures))
    throw UsageError(
        "check bodies: joints are not swept and no pictures are drawn; leave --no-sweeps and "
        "--no-pictures out");
  if (to_muscle_motion(options.muscles) == MuscleMotion::lines && bodies)
    throw UsageError("check bodies: muscles move by the map; leave --muscles out");
  if (options.no_pictures && options.folder.empty())
    throw UsageError("--no-pictures: pictures are drawn with -o FOLDER only; leave it out");
  check_outputs(common, {}, {options.character, options.poses});
  if (!options.folder.empty()) make_output_folder(options.folder);
}

int run_check(const CheckVerbOptions& options, const Common& common, Report& report) {
  check_options(options, common);
  if (options.character == "bodies") return run_bodies(options, common, report);
  const MuscleMotion muscles = to_muscle_motion(options.muscles);
  Character subject = open_subject(options.character, common, report);
  const Skeleton& skeleton = subject.anatomy.skeleton;
  std::vector<LimitPose> poses;
  if (options.poses.empty())
    poses = standard_limit_poses(common.assets.tables, skeleton);
  else if (options.poses != "none")
    poses = read_check_poses(options.poses, skeleton);
  const Actor actor = make_actor(common.assets, std::move(subject), report, {.muscles = muscles});
  const BodyPackage package = read_body_package(common.assets);
  CheckOptions how;
  if (options.no_sweeps) how.sweep_step = 0;
  const Template body_template = read_template(common.assets);
  how.reference = &body_template;
  AnatomyCheck check;
  {
    const StageTimer timer(report, "check");
    check = check_anatomy(actor, package, poses, how, progress_of(common, "poses"));
  }
  report_anatomy_check(check, report);
  const Bulges bulges = measure_bulges(actor);
  report_bulges(bulges, report);
  std::vector<Target> targets = check_targets(check);
  for (Target& target : bulge_targets(bulges)) targets.push_back(std::move(target));
  const bool met =
      std::all_of(targets.begin(), targets.end(), [](const Target& target) { return target.met; });
  report.set_flag("check.met", met);
  std::fputs((check_table(targets) + slits_row(check) + bulge_table(bulges)).c_str(), stdout);
  if (!options.folder.empty()) {
    write_file_atomically(options.folder / "check.csv", check_csv(check, actor.character.anatomy));
    write_file_atomically(options.folder / "check.html",
                          check_page(check, targets, bulges, actor, poses,
                                     {"Check of " + options.character, !options.no_pictures}));
    note(common, fmt::format("look at {0}/check.html; {0}/check.csv has a row a muscle",
                             options.folder.string()));
  }
  if (!options.folder.empty()) {
    report.set("exit_code", met ? 0 : 8);
    report.write(options.folder / "check.json");
  }
  return met ? 0 : 8;
}

}  // namespace

void add_check_verb(VerbRegistry& registry) {
  auto options = std::make_shared<CheckVerbOptions>();
  CLI::App* verb = add_verb(
      registry, registry.app, "check",
      "Measure a character's anatomy: containment, overlap, voids, volumes and paths at the "
      "joints' limits",
      "ecorche check anna-anatomy.glb -o anna-check\n  ecorche check template --poses my-poses.csv "
      "-o out/template-check",
      [options](const Common& common, Report& report) {
        return run_check(*options, common, report);
      });
  verb->add_option("character", options->character,
                   "Character written by `ecorche fit`, `template`: the template in its own body, "
                   "or `bodies`: fitted into twenty bodies, a row each, at rest")
      ->capture_default_str();
  verb->add_option("--body", options->bodies, "With `bodies`: only this one; may be given again")
      ->take_all();
  verb->add_option(
      "-o,--output", options->folder,
      "Folder for check.html, check.csv (a row a muscle) and check.json; made where it is missing");
  verb->add_option(
      "--poses", options->poses,
      "Table of poses (columns pose,joint,flexion,abduction,rotation: shares of the "
      "way to the limit; or name,label,view,angles as posebook takes them); none; those "
      "of data/poses.csv when left out");
  add_muscles_option(*verb, options->muscles);
  verb->add_flag(
      "--no-sweeps", options->no_sweeps,
      "Leave out the sweeps of every joint through its range (volumes and jumps of paths)");
  verb->add_flag("--no-pictures", options->no_pictures, "Leave the pictures out of check.html");
}

}  // namespace ecorche
