#include "app/verbs/statistics_verb.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <ranges>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "app/files/open_body.h"
#include "app/options/option_values.h"
#include "app/options/subject_options.h"
#include "morph/shapes/body_model.h"
#include "morph/shapes/statistic_people.h"
#include "skinning/files/character_write.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct StatisticsOptions {
  fs::path body, output;
  std::string sex, skin_unit;
  std::optional<double> age;
  double height = 0, mass = 0;
  std::vector<std::string> items;  // NAME=LENGTH
  std::vector<fs::path> with;      // registered bodies

  bool changes() const { return age || height > 0 || mass > 0; }
};

StatisticPerson person_of(const BodyModel& model, const Body& body) {
  return {body.skin.V, body.age, kBodyDensity * skin_volume(model.package(), body.skin.V),
          stature(model.package(), body.skin.V)};
}

BodyStatistics statistics_of(const StatisticsOptions& options, const BodyModel& model, Sex sex,
                             const Common& common, Report& report) {
  if (options.with.empty())
    return read_statistics(model.package(), model.tape(), model.adults(sex));
  constexpr std::uint64_t kSeed = 2020;
  std::vector<StatisticPerson> people = draw_statistic_people(
      model.package(), model.tape(), model.adults(sex), kStatisticPeople, kSeed);
  for (const fs::path& file : options.with) {
    const Body body = open_base_body(file, model.package(), common, report, options.skin_unit);
    if (body.sex != sex)
      throw UsageError(
          fmt::format("--with {}: of the other sex; statistics are of one", file.string()));
    people.push_back(person_of(model, body));
  }
  return learn_statistics(sex, people);
}

void print_variance(const BodyStatistics& statistics, Report& report) {
  fmt::print("{} {}: components and the share of variance that they have together\n",
             statistics.people, statistics.sex == Sex::male ? "men" : "women");
  for (const int k : {1, 2, 3, 5, 7, 10, 20, 30, 50})
    if (k <= statistics.explained.size())
      fmt::print("{:3} {:8.2f} %\n", k, 100 * statistics.explained[k - 1]);
  const std::vector<double> explained(statistics.explained.begin(), statistics.explained.end());
  report.set("statistics.people", statistics.people);
  report.set_list("statistics.explained", explained);
}

// What is the old's own: those of 80 beside those of 30 of the same mass and stature.
void print_elders(const BodyStatistics& statistics, const TapeMeasure& tape, Report& report) {
  constexpr double kYoung = 30, kOld = 80;
  constexpr int kShown = 12;
  const double mass = statistics.attribute_mean[1], height = statistics.attribute_mean[2];
  const auto measures = [&](double age) {
    return tape.take_all(
        skin_of_scores(statistics, scores_of_attributes(statistics, age, mass, height)));
  };
  const std::vector<double> young = measures(kYoung), old = measures(kOld);
  std::vector<int> order;
  for (int k = 0; k < tape.count(); ++k) {
    report.set("statistics.elders." + tape.measure(k).id, old[k] - young[k]);
    if (tape.measure(k).kind != MeasureKind::mass) order.push_back(k);
  }
  const auto change = [&](int k) { return std::abs(old[k] - young[k]) / young[k]; };
  std::ranges::stable_sort(order, std::greater{}, change);
  fmt::print("\nat {:.0f} beside {:.0f} years, {:.1f} kg and {:.3f} m: what changes most\n", kOld,
             kYoung, mass, height);
  for (const int k : order | std::views::take(kShown))
    fmt::print("{:28} {:>7.1f} cm {:>+7.1f} cm\n", tape.measure(k).id, 100 * young[k],
               100 * (old[k] - young[k]));
}

std::vector<ItemValue> parse_items(const StatisticsOptions& options, const BodyModel& model) {
  const std::array<AxisItem, 5> known = axis_items(model.package(), model.tape());
  std::vector<ItemValue> out;
  for (const std::string& text : options.items) {
    const std::size_t equals = text.find('=');
    const auto item = std::ranges::find(known, text.substr(0, equals), &AxisItem::name);
    if (equals == std::string::npos || item == known.end())
      throw UsageError(fmt::format(
          "--item {}: NAME=LENGTH, NAME one of {}", text,
          fmt::join(known | std::views::transform([](const AxisItem& i) { return i.name; }),
                    ", ")));
    if (std::ranges::any_of(out, [&](const ItemValue& o) { return o.item.name == item->name; }))
      throw UsageError(fmt::format("--item {}: asked for twice", item->name));
    constexpr LengthRange kPossible{0.05, 3}, kUsual{0.1, 2.3};
    out.push_back(
        {*item, parse_length(text.substr(equals + 1), "--item " + item->name, kPossible, kUsual)});
  }
  return out;
}

// The closed form's body, with its items beside those of our own solver.
Points impose_items(const BodyStatistics& statistics, const std::vector<ItemValue>& items,
                    const BodyModel& model, Report& report) {
  const Eigen::VectorXd scores = scores_of_items(statistics, items);
  const Points closed = skin_of_scores(statistics, scores);
  SolveOptions solve;
  for (const ItemValue& item : items) solve.also.push_back(item_aim(item.item, item.value));
  const SolvedBody own = solve_measures(model.tape(), model.adults(statistics.sex), {}, solve);
  fmt::print("\n{:18} {:>8} {:>12} {:>10}   cm\n", "item", "asked", "closed form", "solver");
  for (const ItemValue& item : items) {
    const double reached = take_item(item.item, closed), solved = take_item(item.item, own.points);
    fmt::print("{:18} {:>8.1f} {:>12.1f} {:>10.1f}\n", item.item.name, 100 * item.value,
               100 * reached, 100 * solved);
    report.set("statistics.items." + item.item.name + ".closed_form", reached);
    report.set("statistics.items." + item.item.name + ".solver", solved);
  }
  fmt::print("closed form: {:.1f} standard deviations from the mean body\n", scores.norm());
  return closed;
}

void print_description(const BodyDescription& description, Report& report) {
  for (const std::string& line : describe(description)) fmt::print("{}\n", line);
  report.set("statistics.distance", description.distance);
  report.set("statistics.percentile", description.percentile);
  report.set_list("statistics.scores", {description.scores.begin(), description.scores.end()});
  report.set("statistics.age", description.age);
  report.set("statistics.mass", description.mass);
  report.set("statistics.stature", description.stature);
}

int run_statistics(const StatisticsOptions& options, const Common& common, Report& report) {
  std::vector<fs::path> inputs = options.with;
  if (!options.body.empty()) inputs.push_back(options.body);
  if (!options.output.empty()) require_ending(options.output, {".glb"});
  check_outputs(common, {options.output}, inputs);
  const bool makes = options.changes() || !options.items.empty();
  if (makes == options.output.empty())
    throw UsageError(makes ? "body statistics: name the body that is made with -o"
                           : "body statistics: -o writes what --age, --height, --mass or --item "
                             "make");
  if (options.changes() && !options.items.empty())
    throw UsageError("body statistics: --item goes without --age, --height and --mass");
  const BodyModel model(common.assets);
  std::optional<Body> body;
  if (!options.body.empty())
    body = open_base_body(options.body, model.package(), common, report, options.skin_unit);
  if (!body && options.sex.empty())
    throw UsageError("body statistics: give a body, or --sex male or female");
  const Sex sex =
      !options.sex.empty() ? (options.sex == "female" ? Sex::female : Sex::male) : body->sex;
  const std::vector<ItemValue> items = parse_items(options, model);
  BodyStatistics statistics;
  {
    const StageTimer timer(report, "statistics");
    statistics = statistics_of(options, model, sex, common, report);
  }
  if (body) {
    print_description(describe_body(statistics, body->skin.V), report);
  } else {
    print_variance(statistics, report);
    print_elders(statistics, model.tape(), report);
  }
  if (!makes) return 0;
  const StatisticPerson now =
      body ? person_of(model, *body)
           : StatisticPerson{statistics.mean, statistics.attribute_mean[0],
                             statistics.attribute_mean[1], statistics.attribute_mean[2]};
  const Eigen::Vector3d from(now.age, now.mass, now.stature);
  const Eigen::Vector3d to(options.age.value_or(now.age),
                           options.mass > 0 ? options.mass : now.mass,
                           options.height > 0 ? options.height : now.stature);
  const Points skin = !items.empty() ? impose_items(statistics, items, model, report)
                                     : change_attributes(statistics, now.skin, from, to);
  check_human(model.tape(), model.adults(sex), skin);
  Body out;
  out.skin = skin_mesh(model.package(), skin);
  out.name = printable(options.output.stem().string());
  out.sex = sex;
  out.age = to[0];
  out.mass = kBodyDensity * skin_volume(model.package(), skin);
  write_body(options.output, out);
  report.set("body.stature", stature(model.package(), skin));
  report.set("body.mass", out.mass);
  note(common, fmt::format("{}: {:.3f} m, {:.1f} kg", options.output.string(),
                           stature(model.package(), skin), out.mass));
  return 0;
}

}  // namespace

void add_body_statistics(VerbRegistry& registry, CLI::App& body) {
  auto options = std::make_shared<StatisticsOptions>();
  CLI::App* verb = add_verb(
      registry, body, "statistics",
      "Where a body lies among people; how bodies vary together, with age, mass and stature",
      "ecorche body statistics anna.glb", [options](const Common& common, Report& report) {
        return run_statistics(*options, common, report);
      });
  add_body_option(*verb, options->body);
  add_sex_option(*verb, options->sex, "People to compare with; the body's own sex when left out");
  verb->add_option("--with", options->with,
                   "A further body, registered from a scan, that the statistics know; may be "
                   "repeated. Example: --with scanned.glb")
      ->check(CLI::ExistingFile);
  verb->add_option("--age", options->age,
                   "Years: the body, or the mean one, as the linear map of the statistics has it "
                   "at that age; body modify --age goes the way of the shape space")
      ->check(between(18.0, 90.0));
  add_length(*verb, "--height", options->height, {0.5, 2.6}, {1.2, 2.3}, "Stature, likewise");
  add_mass(*verb, "--mass", options->mass, 20, 400, "Mass, likewise");
  verb->add_option("--item", options->items,
                   "NAME=LENGTH along the body's axes, in closed form; may be repeated: height, "
                   "shoulder_width, waist_width, waist_thickness, crotch_height. Example: --item "
                   "height=170cm --item waist_width=30cm");
  verb->add_option("-o,--output", options->output, "Body that the options make (.glb)");
  add_skin_unit_option(*verb, "--skin-unit", options->skin_unit);
}

}  // namespace ecorche
