#include "app/verbs/body_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/files/input_file.h"
#include "app/options/option_values.h"
#include "app/options/subject_options.h"
#include "app/verbs/measure_verb.h"
#include "app/verbs/modify_verb.h"
#include "app/verbs/population_verb.h"
#include "app/verbs/register_verb.h"
#include "app/verbs/size_verb.h"
#include "app/verbs/statistics_verb.h"
#include "morph/shapes/body_model.h"
#include "morph/shapes/example_synthesizer.h"
#include "morph/shapes/sizes.h"
#include "skinning/files/character_write.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct NewOptions {
  std::string sex, size, by = "likelihood";
  std::optional<double> age;  // none: the survey's adults
  double height = 0, mass = 0, muscle = -1;
  fs::path output;
  std::vector<std::string> measures;  // NAME=VALUE
  bool best_effort = false, allow_unusual = false;
};

std::vector<MeasureTarget> parse_targets(const Assets& assets, const NewOptions& options,
                                         const TapeMeasure& tape, Sex sex) {
  std::vector<MeasureTarget> out;
  for (const std::string& text : options.measures) out.push_back(parse_target(text, tape));
  if (options.size.empty()) return out;
  // An explicit target overrides the one of the clothing size.
  const int stature = tape.table().at("stature");
  const std::vector<StandardSize> sizes = read_sizes(assets.tables / "body");
  for (const MeasureTarget& target :
       size_targets(find_size(sizes, sex, options.size), tape.table()))
    if (!(target.measure == stature && options.height > 0) &&
        std::none_of(out.begin(), out.end(),
                     [&](const MeasureTarget& own) { return own.measure == target.measure; }))
      out.push_back(target);
  return out;
}

BodySpec spec_of(const Assets& assets, const NewOptions& options, const TapeMeasure& tape) {
  BodySpec spec;
  spec.sex = options.sex == "female" ? Sex::female : Sex::male;
  spec.age = options.age;
  if (options.height > 0) spec.height = options.height;
  if (options.mass > 0) spec.mass = options.mass;
  if (options.muscle >= 0) spec.muscle = options.muscle;
  spec.measures = parse_targets(assets, options, tape, spec.sex);
  spec.name = printable(options.output.stem().string());
  return spec;
}

// Reports targets, achieved values, and the reasons for differences.
std::string report_targets(const MadeBody& made, const TapeMeasure& tape, Report& report) {
  std::string why;
  for (const std::string& reason : made.why) {
    if (!made.solved.conflicts.empty()) report.append_text("conflicts", reason);
    why += "\n  " + reason;
  }
  for (std::size_t i = 0; i < made.targets.size(); ++i) {
    const std::string& id = tape.measure(made.targets[i].measure).id;
    report.set("asked." + id, made.targets[i].value);
    report.set("achieved." + id, made.solved.achieved[i]);
  }
  report.set("worst_miss_in_tolerances", made.worst_miss);
  return why;
}

// Replaces the skin by that of the examples paper's method for the body's own eight measures.
void synthesize_by_examples(const BodyModel& model, MadeBody& made) {
  constexpr int kExamples = 60;  // docs/measures.md has the errors of so many
  const BodyPackage& package = model.package();
  const TapeMeasure& tape = model.tape();
  std::array<double, kPaperMeasures.size()> measures{};
  for (std::size_t k = 0; k < measures.size(); ++k)
    measures[k] = tape.take(tape.table().at(kPaperMeasures[k]), made.solved.points);
  made.solved.points =
      synthesize(learn_synthesizer(package, tape, made.body.sex, kExamples), measures);
  made.body.skin = skin_mesh(package, made.solved.points);
  made.body.mass = kBodyDensity * skin_volume(package, made.solved.points);
  made.worst_miss = 0;
  for (std::size_t i = 0; i < made.targets.size(); ++i) {
    const auto [measure, wanted] = made.targets[i];
    double& achieved = made.solved.achieved[i];
    achieved = tape.take(measure, made.solved.points);
    made.worst_miss =
        std::max(made.worst_miss, std::abs(achieved - wanted) / tape.measure(measure).tolerance);
  }
}

// The most probable body with the targets. Throws UnfitError that names contradictory targets,
// unless --best-effort was given.
int run_new(const NewOptions& options, const Common& common, Report& report) {
  require_ending(options.output, {".glb"});
  check_outputs(common, {options.output});
  const BodyModel model(common.assets);
  const BodySpec spec = spec_of(common.assets, options, model.tape());
  model.adults(spec.sex);  // read before the time is taken
  SolveOptions solve;
  solve.allow_unusual = options.allow_unusual;
  MadeBody made;
  {
    const StageTimer timer(report, "body");
    made = most_probable_body(model, spec, solve);
    if (options.by == "examples") synthesize_by_examples(model, made);
  }
  const std::string why = report_targets(made, model.tape(), report);
  if (!made.met && !options.best_effort)
    throw UnfitError(
        fmt::format("no body has these measures:{}\n  --best-effort writes the nearest body{}", why,
                    made.solved.conflicts.empty()
                        ? ""
                        : ", --allow-unusual tries without asking whether people measure so"));
  write_body(options.output, made.body);
  const double height = stature(model.package(), made.solved.points);
  report.set("body.stature", height);
  report.set("body.mass", made.body.mass);
  report.set("body.volume", made.body.mass / kBodyDensity);
  report.set("body.age", made.body.age);
  report.set("skin_vertices", int(made.body.skin.V.rows()));
  note(common, fmt::format("{}: {}{}, {:.3f} m, {:.1f} kg, {} of its measures asked{}",
                           options.output.string(), options.sex,
                           options.age ? fmt::format(", {:g} years", *options.age) : "", height,
                           made.body.mass, made.targets.size(),
                           made.met ? "" : "; the nearest, because" + why));
  return made.met ? 0 : 8;
}

}  // namespace

void add_body_verb(VerbRegistry& registry) {
  CLI::App* body = registry.app.add_subcommand("body", "Bodies: skins with a known topology");
  body->require_subcommand(1);
  auto options = std::make_shared<NewOptions>();
  CLI::App* verb = add_verb(
      registry, *body, "new", "Make a body of a wanted sex, age, height and mass, or of measures",
      "ecorche body new --sex female --age 30 --height 1.68 --mass 60 -o anna.glb",
      [options](const Common& common, Report& report) {
        return run_new(*options, common, report);
      });
  add_sex_option(*verb, options->sex, "male or female")->required();
  verb->add_option("--age", options->age,
                   "Years, 1 to 90: what is not asked is as people of that age have it; left out, "
                   "as the survey's adults (men of 30.2, women of 29.0 on average)")
      ->check(between(1.0, 90.0));
  add_length(*verb, "--height", options->height, {0.5, 2.6}, {1.2, 2.3},
             "Stature: 1.68, 168cm, 5ft6; the same as --measure stature. Left out, what is most "
             "probable for the rest: with nothing asked, the survey's mean");
  add_mass(*verb, "--mass", options->mass, 2, 400,
           "60kg, 132lb, or kilograms; the same as --measure weight. Left out, what is most "
           "probable for the rest");
  verb->add_option("--muscle", options->muscle,
                   "Share of people of the same sex, stature, mass and other wishes who are less "
                   "muscular, from 0 to 1: limbs and chest larger, the waist smaller")
      ->check(between(0.0, 1.0));
  verb->add_option(
      "--measure", options->measures,
      "NAME=VALUE, met exactly; m, cm, mm, in or ft (kg, lb for weight); may be repeated. "
      "Example: --measure chest_girth=92cm --measure waist_girth=74cm. Names: ecorche list "
      "measures");
  verb->add_option("--size", options->size,
                   "Clothing size XS to 3XL (ecorche list sizes): the body it is made for; "
                   "--measure changes it");
  verb->add_option("--by", options->by,
                   "The skin: likelihood, the most probable body, whose measures are met exactly; "
                   "examples, from 60 bodies by eight measures (girths of neck, chest, underbust, "
                   "waist and hips, stature, crotch height, arm length), met approximately. "
                   "Example: --by examples --measure waist_girth=74cm")
      ->check(one_of({"likelihood", "examples"}))
      ->capture_default_str();
  verb->add_flag("--best-effort", options->best_effort,
                 "Write the nearest body (exit code 8) when measures contradict each other");
  add_unusual_option(*verb, options->allow_unusual);
  add_body_output_option(*verb, options->output);
  add_body_measure(registry, *body);
  add_body_modify(registry, *body);
  add_body_population(registry, *body);
  add_body_register(registry, *body);
  add_body_size(registry, *body);
  add_body_statistics(registry, *body);
}

}  // namespace ecorche
