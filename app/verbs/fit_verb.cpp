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
#include "app/files/register_file.h"
#include "app/files/stranger.h"
#include "app/files/template_file.h"
#include "app/options/motion_options.h"
#include "app/options/option_values.h"
#include "app/options/subject_options.h"
#include "app/pages/registration_page.h"
#include "morph/measures/body_volume.h"
#include "skinning/crowd/crowd_read.h"
#include "skinning/files/character_read.h"

namespace ecorche {
namespace {

const std::map<std::string, Interior> kInteriors{{"bones", Interior::bones},
                                                 {"tetgen", Interior::tetgen},
                                                 {"lattice", Interior::lattice},
                                                 {"rbf", Interior::rbf}};

constexpr double kDoubtfulTorn = 0.004;  // of a stranger's edges
constexpr double kDoubtfulTear = 0.3;    // m, of a single one

struct FitVerbOptions {
  std::filesystem::path body, body_template, output, tissue, weights;
  RegisterFileOptions registration;
  std::string method = "ecorche", skin, sex, interior = "bones";
  std::optional<double> alpha;
  Detail detail = Detail::full;
  FittedActorOptions fitted;
};

// What was fitted, and why it is doubtful that it is the person.
struct FittedBody {
  FittedForFile fitted;
  std::vector<std::string> doubts{};
};

void set_sex(const std::string& sex, Body& body) {
  if (!sex.empty()) body.sex = sex == "female" ? Sex::female : Sex::male;
}

FittedBody fit_own(const FitVerbOptions& options, const BodyPackage& package, const Common& common,
                   Report& report) {
  Body body = open_body(options.body, package, common, report, options.registration.unit);
  set_sex(options.sex, body);
  const Template body_template = open_template(common.assets, options.body_template);
  return {fit_for_file(common.assets, body_template, body, package, options.fitted, report)};
}

// Any other body: registered first, and its own mesh hung on the anatomy.
FittedBody fit_any(const FitVerbOptions& options, const BodyPackage& package, const Common& common,
                   Report& report) {
  const RegistrationModel model = make_registration_model(common.assets);
  RegisteredFile file = register_file(options.body, model, options.registration, common, report);
  Registration& found = file.registration;
  set_sex(options.sex, found.body);
  const RegistrationReport& figures = found.report;
  note(common, fmt::format("registered: {:.1f} cm, {:.0f} kg, {}; scan to body median {:.1f} mm, "
                           "95 % below {:.1f} mm; {:.0f} % of the skin was not seen",
                           100 * stature(package, found.body.skin.V), found.body.mass,
                           found.body.sex == Sex::male ? "male" : "female",
                           1e3 * figures.scan_to_body.median, 1e3 * figures.scan_to_body.p95,
                           100 * figures.unseen));
  report_registration(file.scan, found, registration_distances(file.scan, found, package),
                      stature(package, found.body.skin.V), report);
  const Template body_template = open_template(common.assets, options.body_template);
  const bool own = options.skin.empty() || options.skin == "own";
  if (options.skin == "own" && !file.stranger)
    throw UnfitError(options.body.string() +
                     ": points without faces, or too many of them, have no mesh to move; leave "
                     "--skin out");
  if (own && file.stranger) {
    FittedBody out{fit_stranger(common.assets, body_template, *file.stranger, found, package,
                                options.fitted, report),
                   figures.doubts};
    if (out.fitted.torn_share > kDoubtfulTorn)
      out.doubts.push_back(fmt::format(
          "{:.1f} % of the mesh's edges tear where limbs or clothes touched; see it at rest",
          100 * out.fitted.torn_share));
    if (out.fitted.longest_tear > kDoubtfulTear)
      out.doubts.push_back(
          fmt::format("at rest an edge of the mesh is {:.2f} m longer than it "
                      "stands: some of it hangs on another limb; see it at rest",
                      out.fitted.longest_tear));
    return out;
  }
  return {fit_for_file(common.assets, body_template, found.body, package, options.fitted, report),
          figures.doubts};
}

// Whether the file is neither a body of ours nor a skin on the base mesh.
bool is_stranger(const std::filesystem::path& file, const BodyPackage& package) {
  return !crowd_address(file) && !has_body_notes(file) && !is_base_skin(file, package);
}

void require_known(const FitVerbOptions& options, bool registers) {
  if (registers) return;
  if (options.skin == "own")
    throw UsageError("--skin own: this skin is the base mesh's own; leave it out");
  const RegisterFileOptions& hints = options.registration;
  if (!hints.landmarks.empty() || !hints.pose.empty() || hints.stature > 0)
    throw UsageError(
        "--landmarks, --pose, --stature: this skin is on the base mesh already; leave them out");
}

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
  check_outputs(
      common, {options.output, options.tissue},
      {options.body, options.body_template, options.weights, options.registration.landmarks});
  const BodyPackage package = read_body_package(common.assets);
  const bool registers = is_stranger(options.body, package);
  require_known(options, registers);
  FittedBody made = registers ? fit_any(options, package, common, report)
                              : fit_own(options, package, common, report);
  const FittedForFile& fitted = made.fitted;
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
  for (const std::string& text : made.doubts) note(common, "doubtful: " + text);
  return missed.empty() && made.doubts.empty() ? 0 : 8;
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
  verb->add_option("body", options->body,
                   "Body of `ecorche body new`, a skin on the base mesh, a scan, a sculpt or a "
                   "stranger's character (.glb, .gltf, .fbx, .dae, .obj, .ply, .stl, .off, .pcd)")
      ->required();
  verb->add_option("-o,--output", options->output, "Character to write (.glb)")->required();
  add_template_option(*verb, "--template", options->body_template);
  verb->add_option("--skin", options->skin,
                   "The character's skin: own (a stranger's or a scan's mesh, as it came), base "
                   "(the base mesh), or fine (that refined, 120,404 vertices) "
                   "[own where there is one, else base]")
      ->check(one_of({"own", "base", "fine"}));
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
  add_sex_option(*verb, options->sex,
                 "Of a skin that does not say it; decides the layer of fat (told by its measures "
                 "when left out)");
  add_registration_options(*verb, options->registration);
  add_skin_unit_option(*verb, "--unit", options->registration.unit);
}

}  // namespace ecorche
