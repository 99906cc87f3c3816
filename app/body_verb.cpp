// ecorche body new: a body of a wanted sex, age, height and mass, or of measures taken with a tape.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "anatomy/atomic_file.h"
#include "anatomy/errors.h"
#include "anatomy/input_file.h"
#include "anatomy/package.h"
#include "app/option_values.h"
#include "app/verb.h"
#include "morph/body.h"
#include "morph/sizes.h"
#include "skinning/character_io.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct NewOptions {
  std::string sex, size;
  std::optional<double> age;  // measures alone: people of all ages
  double height = 0, mass = 0, muscle = -1;
  fs::path output;
  std::vector<std::string> measures;  // NAME=VALUE
  bool best_effort = false, allow_unusual = false;
};

std::vector<Wish> parse_wishes(const NewOptions& options, const TapeMeasure& tape, Sex sex) {
  std::vector<Wish> out;
  if (options.height > 0) out.push_back({tape.table().at("stature"), options.height});
  if (options.mass > 0) out.push_back({tape.table().at("weight"), options.mass});
  for (const std::string& text : options.measures) out.push_back(parse_wish(text, tape));
  if (options.size.empty()) return out;
  // What is asked for by itself goes before what the size says of it.
  const std::vector<StandardSize> sizes = read_sizes(data_folder() / "body");
  for (const Wish& wish : size_wishes(find_size(sizes, sex, options.size), tape.table()))
    if (std::none_of(out.begin(), out.end(), [&](const Wish& own) { return own.measure == wish.measure; })) out.push_back(wish);
  return out;
}

// The most probable body with the measures. Impossible ones throw UnfitError that names them, unless best effort is wanted.
int run_measured(const NewOptions& options, const Common& common, Report& report) {
  if (options.muscle >= 0) throw UsageError("--muscle cannot be combined with --measure or --size; give girths instead");
  const BodyPackage package = read_body_package(find_packages());
  const TapeMeasure tape(package, read_measure_table(package, data_folder() / "body"));
  const Sex sex = options.sex == "female" ? Sex::female : Sex::male;
  const std::vector<Wish> wishes = parse_wishes(options, tape, sex);
  ShapeSpace space = read_shape_space(package, tape, sex);
  if (options.age) move_to_age(package, tape, *options.age, space);
  SolveOptions solve;
  solve.allow_unusual = options.allow_unusual;
  SolvedBody solved;
  {
    const StageTimer timer(report, "body");
    solved = solve_measures(tape, space, wishes, solve);
  }
  std::string why;
  for (const Conflict& conflict : solved.conflicts) {
    const std::string text = describe(conflict, tape, wishes);
    report.append_text("conflicts", text);
    why += "\n  " + text;
  }
  double worst = 0;
  for (std::size_t i = 0; i < wishes.size(); ++i) {
    const Measure& m = tape.measure(wishes[i].measure);
    const double off = solved.achieved[i] - wishes[i].value;
    report.set("asked." + m.id, wishes[i].value);
    report.set("achieved." + m.id, solved.achieved[i]);
    worst = std::max(worst, std::abs(off) / m.tolerance);
    if (std::abs(off) > m.tolerance && solved.conflicts.empty()) why += fmt::format("\n  {} asked {:.3f}, nearest {:.3f}", m.id, wishes[i].value, solved.achieved[i]);
  }
  report.set("worst_miss_in_tolerances", worst);
  const bool met = solved.conflicts.empty() && worst <= 1;
  if (!met && !options.best_effort)
    throw UnfitError(fmt::format("no body has these measures:{}\n  --best-effort writes the nearest body{}", why,
                                 solved.conflicts.empty() ? "" : ", --allow-unusual tries without asking whether people measure so"));
  Body body;
  body.skin = skin_mesh(package, solved.points);
  body.name = printable(options.output.stem().string());
  body.sex = sex;
  if (options.age) body.age = *options.age;
  body.mass = kBodyDensity * skin_volume(package, solved.points);
  write_body(options.output, body);
  report.set("body.stature", stature(package, solved.points));
  report.set("body.mass", body.mass);
  report.set("skin_vertices", static_cast<int>(body.skin.V.rows()));
  note(common, fmt::format("{}: {}, {:.3f} m, {:.1f} kg, {} of its measures asked{}", options.output.string(), options.sex,
                           stature(package, solved.points), body.mass, wishes.size(), met ? "" : "; the nearest, because" + why));
  return met ? 0 : 8;
}

int run_new(const NewOptions& options, const Common& common, Report& report) {
  require_ending(options.output, {".glb"});
  check_outputs(common, {options.output});
  if (!options.measures.empty() || !options.size.empty()) return run_measured(options, common, report);
  BodySpec spec;
  spec.sex = options.sex == "female" ? Sex::female : Sex::male;
  if (options.age) spec.age = *options.age;
  if (options.height > 0) spec.height = options.height;
  if (options.mass > 0) spec.mass = options.mass;
  if (options.muscle >= 0) spec.muscle = options.muscle;
  spec.name = printable(options.output.stem().string());

  const BodyPackage package = read_body_package(find_packages());
  const StageTimer timer(report, "body");
  const ShapedBody shaped = shape_body(package, spec);
  write_body(options.output, shaped.body);
  report.set("body.stature", shaped.stature);
  report.set("body.mass", shaped.mass);
  report.set("body.volume", shaped.volume);
  report.set("skin_vertices", static_cast<int>(shaped.body.skin.V.rows()));
  note(common, fmt::format("{}: {}, {:.0f} years, {:.3f} m, {:.1f} kg", options.output.string(), options.sex, spec.age, shaped.stature, shaped.mass));
  return 0;
}

}  // namespace

void add_body_verb(VerbRegistry& registry) {
  CLI::App* body = registry.app.add_subcommand("body", "Bodies: skins with a known topology");
  body->require_subcommand(1);
  auto options = std::make_shared<NewOptions>();
  CLI::App* verb = add_verb(registry, *body, "new", "Make a body of a wanted sex, age, height and mass, or of measures",
                            "ecorche body new --sex female --age 30 --height 1.68 --mass 60 -o anna.glb",
                            [options](const Common& common, Report& report) { return run_new(*options, common, report); });
  verb->add_option("--sex", options->sex, "male or female")->required()->check(one_of({"male", "female"}));
  verb->add_option("--age", options->age, "Years; 25 when left out, and with --measure people of all ages")->check(between(1.0, 90.0));
  add_length(*verb, "--height", options->height, {0.5, 2.6}, {1.2, 2.3}, "Stature: 1.68, 168cm, 5ft6; the average when left out");
  add_mass(*verb, "--mass", options->mass, 2, 400, "60kg, 132lb, or kilograms; follows from an average build when left out");
  verb->add_option("--muscle", options->muscle, "Muscularity from 0 to 1; follows from the mass when left out")->check(between(0.0, 1.0));
  verb->add_option("--measure", options->measures,
                   "NAME=VALUE, met exactly; m, cm, mm, in or ft (kg, lb for weight); may be repeated. "
                   "Example: --measure chest_girth=92cm --measure waist_girth=74cm. Names: ecorche list measures");
  verb->add_option("--size", options->size, "Clothing size XS to 3XL (ecorche list sizes): the body it is made for; --measure changes it");
  verb->add_flag("--best-effort", options->best_effort, "Write the nearest body (exit code 8) when measures contradict each other");
  verb->add_flag("--allow-unusual", options->allow_unusual, "Accept measures that people do not have, as far as the skin can be bent");
  verb->add_option("-o,--output", options->output, "Body file to write (.glb)")->required();
  add_body_measure(registry, *body);
  add_body_modify(registry, *body);
  add_body_population(registry, *body);
  add_body_size(registry, *body);
}

}  // namespace ecorche
