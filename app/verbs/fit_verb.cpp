#include "app/verbs/fit_verb.h"

#include <CLI/CLI.hpp>
#include <map>

#include <fmt/format.h>

#include "anatomy/base_mesh/skin_import.h"
#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "app/files/character_file.h"
#include "app/files/fitted_actor.h"
#include "app/files/open_body.h"
#include "app/files/template_file.h"
#include "app/options/motion_options.h"
#include "app/options/option_values.h"
#include "app/options/subject_options.h"

namespace ecorche {
namespace {

const std::map<std::string, Interior> kInteriors{{"bones", Interior::bones},
                                                 {"tetgen", Interior::tetgen},
                                                 {"lattice", Interior::lattice},
                                                 {"rbf", Interior::rbf}};

struct FitVerbOptions {
  std::filesystem::path body, body_template, output, tissue, weights;
  std::string method = "ecorche", skin = "base", sex, unit, interior = "bones";
  std::optional<double> alpha;
  Detail detail = Detail::full;
  FittedActorOptions fitted;
};

int run_fit(FitVerbOptions options, const Common& common, Report& report) {
  if (options.method == "paper") options.fitted.fitting.dilate.method = DilateMethod::paper;
  options.fitted.fitting.dilate.share = options.method == "ecorche";
  options.fitted.fitting.fit.interior = kInteriors.at(options.interior);
  options.fitted.fine_skin = options.skin == "fine";
  options.fitted.weights = options.weights;
  require_ending(options.output, {".glb"});
  if (options.alpha && options.method != "paper")
    throw UsageError("--alpha: only --method paper has it; leave it out");
  if (options.alpha) options.fitted.fitting.dilate.alpha = *options.alpha;
  const bool meshed = options.fitted.fitting.fit.interior == Interior::tetgen ||
                      options.fitted.fitting.fit.interior == Interior::lattice;
  if (!options.tissue.empty()) {
    if (!meshed)
      throw UsageError("--tissue: there is a mesh only with --interior tetgen or lattice");
    require_ending(options.tissue, {".vtk"});
  }
  check_outputs(common, {options.output, options.tissue},
                {options.body, options.body_template, options.weights});
  const BodyPackage package = read_body_package(common.assets);
  Body body = open_body(options.body, package, common, report, options.unit);
  if (!options.sex.empty()) body.sex = options.sex == "female" ? Sex::female : Sex::male;
  const Template body_template = open_template(common.assets, options.body_template);
  const FittedForFile fitted =
      fit_for_file(common.assets, body_template, body, package, options.fitted, report);
  const BoundCharacter& bound = fitted.bound;
  write_character_file(common.assets, options.output, bound.character, bound.binding,
                       options.detail, package);
  if (!options.tissue.empty()) {
    write_tissue_vtk(options.tissue, fitted.tissue);
    note(common, fmt::format("{}: {} tetrahedra", options.tissue.string(), fitted.tissue.T.rows()));
  }
  note(common, fmt::format("{}: {} bones, {} muscles, {} skin vertices", options.output.string(),
                           bound.character.anatomy.bones.size(),
                           bound.character.anatomy.muscles.size(), bound.binding.vertex_count));
  const auto missed = missed_targets(fitted.report);
  for (const MissedTarget& target : missed) note(common, "missed: " + target.what);
  return missed.empty() ? 0 : 8;
}

}  // namespace

void add_fit_verb(VerbRegistry& registry) {
  auto options = std::make_shared<FitVerbOptions>();
  CLI::App* verb = add_verb(registry, registry.app, "fit",
                            "Put bones and muscles inside a skin, and anchor the skin to them",
                            "ecorche fit anna.glb -o anna-anatomy.glb --report anna.json",
                            [options](const Common& common, Report& report) {
                              return run_fit(*options, common, report);
                            });
  verb->add_option(
          "body", options->body,
          "Body of `ecorche body new`, or a skin in the base mesh's topology (.obj, .ply, .glb)")
      ->required();
  verb->add_option("-o,--output", options->output, "Character to write (.glb)")->required();
  add_template_option(*verb, "--template", options->body_template);
  verb->add_option(
          "--skin", options->skin,
          "The character's skin: base (the body's own mesh), or fine (refined, 120,404 vertices)")
      ->check(one_of({"base", "fine"}))
      ->capture_default_str();
  verb->add_option("--method", options->method,
                   "How muscles grow to the skin: ecorche; ellipses (the same, but neighbours do "
                   "not part: faster), or paper (one factor a muscle)")
      ->check(one_of({"ecorche", "ellipses", "paper"}))
      ->capture_default_str();
  verb->add_option("--interior", options->interior,
                   "What carries the flesh into the body before it grows: the bones it rides on, a "
                   "harmonic warp of the tissue between bones and skin "
                   "(tetgen: tetrahedra, lattice: cubes), or radial functions (rbf)")
      ->check(one_of({"bones", "tetgen", "lattice", "rbf"}))
      ->capture_default_str();
  verb->add_option("--tissue", options->tissue,
                   "Tetrahedra between bones and skin, for simulations (.vtk); with --interior "
                   "tetgen or lattice");
  add_weights_option(*verb, options->weights);
  add_detail_option(*verb, options->detail);
  verb->add_option("--alpha", options->alpha,
                   fmt::format("With --method paper: share of their length's change that muscles "
                               "start with across [{}]",
                               DilateOptions{}.alpha))
      ->check(between(0.01, 10.0));
  add_sex_option(
      *verb, options->sex,
      "Of a skin that does not say it; decides the layer of fat (a bare skin counts as male)");
  add_skin_unit_option(*verb, "--unit", options->unit);
}

}  // namespace ecorche
