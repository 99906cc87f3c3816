#include "app/verbs/population_verb.h"

#include <fmt/format.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <fstream>
#include <functional>
#include <sstream>

#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/files/package_archive.h"
#include "app/files/actor.h"
#include "app/files/fitted_actor.h"
#include "app/options/option_values.h"
#include "app/options/subject_options.h"
#include "app/progress.h"
#include "morph/shapes/population.h"
#include "morph/shapes/shape_age.h"
#include "morph/shapes/shape_space_cache.h"
#include "morph/shapes/sizes.h"
#include "morph/template/template_cache.h"
#include "population_code.h"  // generated: kPopulationCode
#include "skinning/crowd/crowd_file.h"
#include "skinning/crowd/crowd_person.h"
#include "skinning/crowd/crowd_prototype.h"
#include "skinning/files/character_write.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct PopulationOptions {
  fs::path people, folder, crowd;
  int count = 0;
  std::string sex;
  bool skins = false, allow_unusual = false;
};

constexpr const char* kHeader =
    "name,sex,age,stature_m,weight_kg,worst_miss_in_tolerances,anatomy,missed\n";

// Number of people made in parallel, one a core: half of a fit is serial. More of them would
// need more memory.
constexpr int kMostAtOnce = 4;

// Read-only data of all people: packages, tables, shape spaces, the template.
struct Workshop {
  explicit Workshop(const Assets& opened) : assets(opened) {}

  Assets assets;
  BodyPackage package = read_body_package(assets);
  TapeMeasure tape{package, read_measure_table(package, package.tables / "body")};
  std::vector<VertexPart> parts = vertex_parts(package);
  std::optional<ShapeSpace> spaces[2];
  std::optional<Template> body_template;
  std::optional<LayerOrder> layers;         // of it, where muscles are fitted
  std::optional<CrowdPrototype> prototype;  // of a crowd

  void prepare(Sex sex) {
    auto& kept = spaces[sex == Sex::male ? 0 : 1];
    if (!kept) kept = read_shape_space(package, tape, sex);
  }
  const ShapeSpace& space(Sex sex) const { return *spaces[sex == Sex::male ? 0 : 1]; }
};

// Key of everything that a person's files depend on. An edited row has another key and is fitted
// again.
std::string row_key(const Person& person, const PopulationOptions& options,
                    const std::string& versions) {
  std::string text = fmt::format("{} {} {} {} {}", versions, person.name,
                                 person.sex == Sex::male ? "male" : "female", options.skins,
                                 options.allow_unusual);
  text += options.crowd.empty() ? "" : fmt::format(" crowd {}", kCrowdSchema);
  text += person.age ? fmt::format(" age {}", *person.age) : "";
  text += person.draw ? fmt::format(" draw {}", *person.draw) : "";
  for (const MeasureTarget& target : person.targets)
    text += fmt::format(" {}={}", target.measure, target.value);
  return sha256(text);
}

double worst_miss(const TapeMeasure& tape, const Person& person, const SolvedBody& solved) {
  double worst = 0;
  for (std::size_t i = 0; i < person.targets.size(); ++i)
    worst = std::max(worst, std::abs(solved.achieved[i] - person.targets[i].value) /
                                tape.measure(person.targets[i].measure).tolerance);
  return worst;
}

// Writes the person's file and returns its row of population.csv.
std::string make_files(const Workshop& shop, const Person& person, const PopulationOptions& options,
                       const fs::path& file) {
  SolveOptions solve;
  solve.allow_unusual = options.allow_unusual;
  std::optional<ShapeSpace> of_age;
  if (person.age) {
    of_age = shop.space(person.sex);
    move_to_age(shop.package, shop.tape, *person.age, *of_age);
  }
  const SolvedBody solved =
      make_person(shop.tape, of_age ? *of_age : shop.space(person.sex), person, solve);
  Body body;
  body.skin = skin_mesh(shop.package, solved.points);
  body.name = person.name;
  body.sex = person.sex;
  body.age = person.age.value_or(kSurveyAge);
  body.mass = kBodyDensity * skin_volume(shop.package, solved.points);
  std::string anatomy = "none", names;
  Report own;
  if (options.skins && shop.prototype) {
    // Joints and weights depend on the bones alone; muscles are not dilated.
    const BoundCharacter bound =
        bind_character(shop.assets, {fit_anatomy(*shop.body_template, body).anatomy, body}, own);
    write_crowd_person(file, *shop.prototype, bound.character, bound.binding.joint_weights);
  } else if (options.skins) {
    write_body(file, body);
  } else {
    const FittedForFile fitted = fit_for_file(
        shop.assets, *shop.body_template, body, shop.package,
        {.fitting = {.tissues = false, .parts = &shop.parts, .layers = &*shop.layers}}, own);
    const std::vector<MissedTarget> missed = missed_targets(fitted.report);
    anatomy = missed.empty() ? "met" : fmt::format("{} targets missed", missed.size());
    for (const MissedTarget& target : missed) names += (names.empty() ? "" : ";") + target.name;
    if (shop.prototype)
      write_crowd_person(file, *shop.prototype, fitted.bound.character,
                         fitted.bound.binding.joint_weights);
    else
      write_character(file, fitted.bound.character, fitted.bound.binding, nullptr,
                      find_look(shop.package, body.skin, fitted.bound.character.anatomy.skeleton));
  }
  return fmt::format("{},{},{},{:.4f},{:.2f},{:.3f},{},{}\n", person.name,
                     person.sex == Sex::male ? "male" : "female",
                     person.age ? fmt::format("{}", *person.age) : "",
                     stature(shop.package, solved.points), body.mass,
                     worst_miss(shop.tape, person, solved), anatomy, names);
}

// The person's row of population.csv if the files exist and have the same key; otherwise empty.
std::string finished_row(const fs::path& note, const fs::path& file, const std::string& key) {
  std::ifstream in(note);
  std::string found, row;
  if (!fs::exists(file) || !std::getline(in, found) || found != key || !std::getline(in, row))
    return {};
  return row + "\n";
}

fs::path person_file(const Workshop& shop, const Person& person, const PopulationOptions& options) {
  return options.folder / (person.name + (shop.prototype ? ".bin" : ".glb"));
}

// Result of one person.
struct Outcome {
  std::string row;      // of population.csv; empty for one who was refused
  std::string refused;  // why
  bool kept = false;    // was there already
};

Outcome make_person_once(const Workshop& shop, const Person& person,
                         const PopulationOptions& options, const std::string& versions) {
  const fs::path file = person_file(shop, person, options),
                 done = options.folder / ".rows" / person.name;
  const std::string key = row_key(person, options, versions);
  Outcome out{finished_row(done, file, key), {}, true};
  if (!out.row.empty()) return out;
  out.kept = false;
  try {
    out.row = make_files(shop, person, options, file);
    write_file_atomically(done, key + "\n" + out.row);
  } catch (const UnfitError& e) {
    out.refused = e.what();
  }
  return out;
}

// Makes several people in parallel; `take` receives them one by one, in order.
void make_people(const Workshop& shop, const std::vector<Person>& people,
                 const PopulationOptions& options, const std::string& versions,
                 const std::function<void(const Person&, const Outcome&)>& take) {
  struct Made {
    const Person* person;
    Outcome outcome;
  };
  std::size_t next = 0;
  const auto begin = tbb::make_filter<void, std::size_t>(
      tbb::filter_mode::serial_in_order, [&](tbb::flow_control& flow) -> std::size_t {
        if (next == people.size()) flow.stop();
        return next++;
      });
  // A thread that waits within one person's fit must not start another person.
  const auto make =
      tbb::make_filter<std::size_t, Made>(tbb::filter_mode::parallel, [&](std::size_t i) {
        return Made{&people[i], tbb::this_task_arena::isolate([&] {
                      return make_person_once(shop, people[i], options, versions);
                    })};
      });
  const auto end =
      tbb::make_filter<Made, void>(tbb::filter_mode::serial_in_order,
                                   [&](const Made& made) { take(*made.person, made.outcome); });
  tbb::parallel_pipeline(
      std::size_t(std::min(tbb::this_task_arena::max_concurrency(), kMostAtOnce)),
      begin & make & end);
}

bool misses_targets(const std::string& row) {
  return !Table(kHeader + row, "population.csv").text(0, "missed").empty();
}

// Figures of one person in a crowd: the row of population.csv and the targets.
CrowdMember crowd_member(const MeasureTable& table, const Person& person, const fs::path& file,
                         const std::string& row) {
  CrowdMember out{person.name, file, {}, {}};
  const Table cells(kHeader + row, "population.csv");
  for (const char* column : {"sex", "anatomy"})
    out.notes.emplace_back(column, cells.text(0, column));
  for (const char* column : {"age", "stature_m", "weight_kg", "worst_miss_in_tolerances"})
    if (!cells.text(0, column).empty()) out.figures.emplace_back(column, cells.number(0, column));
  for (const MeasureTarget& target : person.targets)
    out.figures.emplace_back("asked_" + table.measures[target.measure].id, target.value);
  return out;
}

void check_crowd(const PopulationOptions& options) {
  if (options.crowd.empty()) return;
  require_ending(options.crowd, {".glb", ".gltf"});
  // Reported before the people are fitted.
  if (options.crowd.extension() == ".gltf" &&
      fs::weakly_canonical(fs::absolute(options.crowd).parent_path()) !=
          fs::weakly_canonical(fs::absolute(options.folder)))
    throw UsageError(fmt::format("{}: a .gltf must lie in the folder of the people's files, {}",
                                 options.crowd.string(), options.folder.string()));
}

int run_population(const PopulationOptions& options, const Common& common, Report& report) {
  if (options.people.empty() == (options.count == 0))
    throw UsageError("body population: give a file of measures or --count, one of them");
  check_crowd(options);
  check_outputs(common, {options.crowd}, {options.people});
  std::optional<Sex> sex;
  if (!options.sex.empty()) sex = options.sex == "female" ? Sex::female : Sex::male;
  Workshop shop(common.assets);
  People people;
  if (options.people.empty())
    people.people = draw_people(options.count, sex, common.seed);
  else
    people = read_people(options.people, sex, shop.tape, read_sizes(common.assets.tables / "body"));
  for (const BadRow& bad : people.bad) note(common, bad.what);
  if (people.people.empty())
    throw InputError(fmt::format("{} ({} rows, none of which can be used)", people.bad.front().what,
                                 people.bad.size()));
  if (!options.skins || !options.crowd.empty()) shop.body_template = read_template(common.assets);
  if (!options.skins) shop.layers = template_layers(*shop.body_template, shop.package);
  const fs::path notes = options.folder / ".rows";
  make_output_folder(notes);
  if (!options.crowd.empty()) {
    shop.prototype =
        make_crowd_prototype({shop.body_template->anatomy, shop.body_template->body},
                             options.skins ? CrowdLayers::skin_alone : CrowdLayers::all);
  }

  for (const Person& person : people.people) shop.prepare(person.sex);
  const std::string versions =
      fmt::format("{} {} {} {} {}", ECORCHE_VERSION, kPopulationCode,
                  shop.body_template ? template_key(common.assets.tables) : "",
                  shape_space_key(common.assets.tables, Sex::male),
                  shape_space_key(common.assets.tables, Sex::female));
  std::string table = kHeader;
  std::vector<CrowdMember> members;
  int made = 0, kept = 0, refused = 0, missed = 0;
  const int total = people.people.size();
  const StageTimer timer(report, "population");
  Progress progress(common, "people", total);
  make_people(shop, people.people, options, versions,
              [&](const Person& person, const Outcome& outcome) {
                progress.step();
                if (outcome.row.empty()) {
                  note(common, fmt::format("{}: {}", person.name, outcome.refused));
                  report.append_text("population.refused_people", person.name);
                  ++refused;
                  return;
                }
                ++(outcome.kept ? kept : made);
                missed += misses_targets(outcome.row);
                table += outcome.row;
                if (shop.prototype)
                  members.push_back(crowd_member(shop.tape.table(), person,
                                                 person_file(shop, person, options), outcome.row));
              });
  write_file_atomically(options.folder / "population.csv", table);
  if (!members.empty()) {
    std::sort(members.begin(), members.end(),
              [](const CrowdMember& a, const CrowdMember& b) { return a.name < b.name; });
    const StageTimer crowd_timer(report, "crowd");
    write_crowd(options.crowd, *shop.prototype, members);
    report.set("population.crowd_bytes", double(fs::file_size(options.crowd)));
  }
  report.set("population.people", made + kept);
  report.set("population.kept", kept);
  report.set("population.refused", refused);
  report.set("population.bad_rows", int(people.bad.size()));
  report.set("population.anatomy_targets_missed", missed);
  for (const BadRow& bad : people.bad) report.append_text("population.bad_row", bad.what);
  note(common,
       fmt::format("{}: {} people ({} were there), {} refused, {} bad rows, {} with an anatomy "
                   "target missed",
                   options.folder.string(), made + kept, kept, refused, people.bad.size(), missed));
  if (made + kept == 0) throw UnfitError("no row gave a body");
  return refused > 0 || missed > 0 || !people.bad.empty() ? 8 : 0;
}

}  // namespace

void add_body_population(VerbRegistry& registry, CLI::App& body) {
  auto options = std::make_shared<PopulationOptions>();
  CLI::App* verb =
      add_verb(registry, body, "population",
               "Make many people, from a CSV of measures or by chance, with their anatomy",
               "ecorche body population people.csv -o people",
               [options](const Common& common, Report& report) {
                 return run_population(*options, common, report);
               });
  verb->add_option("people", options->people,
                   "CSV with a row a person; columns name, sex, age, size and measures (ecorche "
                   "body measure --list)");
  verb->add_option("--count", options->count,
                   "Instead of a file: so many people by chance, with the survey's means, spreads "
                   "and correlations (--seed)")
      ->check(between(1, 1000000));
  add_sex_option(*verb, options->sex, "Of rows that do not say it; with --count, of all");
  verb->add_option("--crowd", options->crowd,
                   "One file of all people (.glb, or .gltf in the folder, referring to the "
                   "people's own files): what they have in common is there once");
  verb->add_flag("--skins", options->skins,
                 "Skins alone, without bones and muscles; in a crowd with joints that move them");
  add_unusual_option(*verb, options->allow_unusual);
  verb->add_option("-o,--output", options->folder,
                   "Folder to write; people that are there already from the same row are kept")
      ->required();
}

}  // namespace ecorche
