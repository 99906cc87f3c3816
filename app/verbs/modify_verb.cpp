#include "app/verbs/modify_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "app/files/open_body.h"
#include "app/options/option_values.h"
#include "app/options/subject_options.h"
#include "morph/shapes/modify_body.h"
#include "morph/shapes/shape_age.h"
#include "morph/shapes/shape_space_cache.h"
#include "skinning/files/character_write.h"

namespace ecorche {
namespace {

struct ModifyOptions {
  std::filesystem::path body, output;
  std::optional<double> fat, hip_waist, age;
  double muscle = 0, exaggeration = 1;
  std::vector<std::string> measures;
  std::string sex, unit;
};

int run_modify(const ModifyOptions& options, const Common& common, Report& report) {
  require_ending(options.output, {".glb"});
  check_outputs(common, {options.output}, {options.body});
  const BodyPackage package = read_body_package(common.assets);
  const TapeMeasure tape(package, read_measure_table(package, package.tables / "body"));
  Body body = open_base_body(options.body, package, common, report, options.unit);
  if (!options.sex.empty()) body.sex = options.sex == "female" ? Sex::female : Sex::male;
  const ShapeSpace space = read_shape_space(package, tape, body.sex);
  BodyChange change;
  change.fat = options.fat;
  change.hip_waist = options.hip_waist;
  change.muscle = options.muscle;
  change.exaggeration = options.exaggeration;
  const double own_age = body.age > 0 ? body.age : kSurveyAge;
  change.age = std::pair{own_age, options.age.value_or(own_age)};
  for (const std::string& text : options.measures)
    change.measures.push_back(parse_target(text, tape));
  const auto figures = [&](const char* when, const Points& skin) {
    const double fat = fat_percentage(tape, body.sex, skin), ratio = hip_waist_ratio(tape, skin);
    report.set(fmt::format("{}.fat_percent", when), fat);
    report.set(fmt::format("{}.hip_waist_ratio", when), ratio);
    report.set(fmt::format("{}.weight", when), kBodyDensity * skin_volume(package, skin));
    return fmt::format("fat {:.1f} %, hip to waist {:.3f}, {:.1f} kg", fat, ratio,
                       kBodyDensity * skin_volume(package, skin));
  };
  ShapeSpace people = space;
  move_to_age(package, tape, change.age->second, people);
  check_change(tape, people, body.skin.V, change);
  const std::string before = figures("before", body.skin.V);
  ChangedBody changed;
  {
    const StageTimer timer(report, "body");
    changed = change_body(package, tape, space, body.skin.V, change);
  }
  check_human(tape, people, changed.points);
  const std::string after = figures("after", changed.points);
  body.skin = skin_mesh(package, changed.points);
  body.mass = kBodyDensity * skin_volume(package, changed.points);
  body.landmarks.clear();
  if (options.age) body.age = *options.age;
  write_body(options.output, body);
  note(common, fmt::format("{}: {}; was {}{}", options.output.string(), after, before,
                           changed.met ? "" : "; not all that was asked for could be met"));
  return changed.met ? 0 : 8;
}

}  // namespace

void add_body_modify(VerbRegistry& registry, CLI::App& body) {
  auto options = std::make_shared<ModifyOptions>();
  CLI::App* verb = add_verb(registry, body, "modify",
                            "Change a body by attributes and keep what is the person's own",
                            "ecorche body modify anna.glb --fat 32 -o anna-heavier.glb",
                            [options](const Common& common, Report& report) {
                              return run_modify(*options, common, report);
                            });
  add_body_option(*verb, options->body)->required();
  verb->add_option("--fat", options->fat, "Share of fat, per cent, by girths and height")
      ->check(between(2.0, 60.0));
  verb->add_option("--hip-waist", options->hip_waist, "Hip girth over waist girth")
      ->check(between(0.7, 2.0));
  verb->add_option("--measure", options->measures,
                   "NAME=VALUE, as for body new; may be repeated. Lengths not asked for stay");
  verb->add_option("--muscle", options->muscle,
                   "From -1, as weak as people of that stature and mass are, to 1, as muscular; "
                   "the mass stays where it is not asked for")
      ->check(between(-1.0, 1.0));
  verb->add_option("--age", options->age, "Years that the body is to be old")
      ->check(between(1.0, 90.0));
  verb->add_option("--exaggerate", options->exaggeration,
                   "More (above 1) or less (below 1) of what sets the body apart from the average")
      ->check(between(0.0, 3.0));
  add_sex_option(*verb, options->sex, "Of a body that does not say it");
  add_skin_unit_option(*verb, "--skin-unit", options->unit);
  add_body_output_option(*verb, options->output);
}

}  // namespace ecorche
