#include "app/verbs/measure_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <nlohmann/json.hpp>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "app/files/open_body.h"
#include "app/options/option_values.h"
#include "app/options/subject_options.h"
#include "app/pages/html_page.h"
#include "app/pages/tape_pictures.h"
#include "morph/measures/tape_measure.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct MeasureOptions {
  fs::path body, html;
  bool list = false, json = false, csv = false;
  std::string unit = "cm", skin_unit;
};

struct Unit {
  std::string name;
  double per_metre = 1;
};

Unit unit_of(const std::string& name) {
  if (name == "mm") return {name, 1000};
  if (name == "cm") return {name, 100};
  if (name == "in") return {name, 1 / 0.0254};
  if (name == "ft") return {name, 1 / 0.3048};
  return {"m", 1};
}

std::string shown(const Measure& m, double value, const Unit& unit) {
  if (m.kind == MeasureKind::mass) return fmt::format("{:.1f} kg", value);
  return fmt::format("{:.{}f} {}", value * unit.per_metre,
                     unit.name == "m"    ? 3
                     : unit.name == "mm" ? 0
                                         : 1,
                     unit.name);
}

std::vector<std::vector<std::string>> table_rows(const TapeMeasure& tape,
                                                 const std::vector<double>& values,
                                                 const Unit& unit) {
  std::vector<std::vector<std::string>> rows;
  for (int k = 0; k < tape.count(); ++k) {
    const Measure& m = tape.measure(k);
    rows.push_back({m.id, m.name, shown(m, values[k], unit), m.standard, m.note});
  }
  return rows;
}

void print_measure(const TapeMeasure& tape, const std::vector<double>& values,
                   const MeasureOptions& options) {
  const Unit unit = unit_of(options.unit);
  if (options.json) {
    nlohmann::ordered_json out;
    for (int k = 0; k < tape.count(); ++k)
      out[tape.measure(k).id] =
          std::isfinite(values[k]) ? nlohmann::ordered_json(values[k]) : nullptr;
    fmt::print("{}\n", out.dump(2));
    return;
  }
  if (options.csv) fmt::print("id,value,unit\n");
  for (int k = 0; k < tape.count(); ++k) {
    const Measure& m = tape.measure(k);
    const double value = values[k];
    if (options.csv) {
      const bool mass = m.kind == MeasureKind::mass;
      fmt::print("{},{:.4f},{}\n", m.id, mass ? value : value * unit.per_metre,
                 mass ? "kg" : unit.name);
    } else {
      fmt::print("{:28} {:>10}   {}\n", m.id, shown(m, value, unit), m.name);
    }
  }
}

int run_measure(const MeasureOptions& options, const Common& common, Report& report) {
  const BodyPackage package = read_body_package(common.assets);
  const TapeMeasure tape(package, read_measure_table(package, package.tables / "body"));
  if (options.list) {
    for (int k = 0; k < tape.count(); ++k)
      fmt::print("{:28} {}\n", tape.measure(k).id, tape.measure(k).name);
    return 0;
  }
  if (options.body.empty())
    throw UsageError("body measure: give a body file, or --list for the names of the measures");
  check_outputs(common, {options.html}, {options.body});
  const Body body = open_base_body(options.body, package, common, report, options.skin_unit);
  std::vector<double> values;
  {
    const StageTimer timer(report, "measure");
    values = tape.take_all(body.skin.V);
  }
  for (int k = 0; k < tape.count(); ++k) report.set("measures." + tape.measure(k).id, values[k]);
  if (!options.html.empty()) {
    HtmlPage page("Measures of " + (body.name.empty() ? options.body.stem().string() : body.name));
    const std::vector<std::string> header{"id", "measure", "value", "standard", "note"};
    try {
      Renderer renderer;
      const Image sheet = sheet_of_tapes(renderer, tape, body.skin, 620, 860);
      page.add_picture(
          encode_png(sheet),
          "Where the tapes, callipers and sticks lie. Paired measures are taken on the left.");
    } catch (const OutputError& e) {
      note(common, fmt::format("no picture: {}", e.what()));  // the page is of use without it
    }
    page.add_table(header, table_rows(tape, values, unit_of(options.unit)));
    write_file_atomically(options.html, page.to_string());
    note(common, fmt::format("{}: {} measures", options.html.string(), tape.count()));
    return 0;
  }
  print_measure(tape, values, options);
  return 0;
}

}  // namespace

void add_body_measure(VerbRegistry& registry, CLI::App& body) {
  auto options = std::make_shared<MeasureOptions>();
  CLI::App* verb = add_verb(
      registry, body, "measure", "Measure a body: heights, lengths, breadths, depths, girths, mass",
      "ecorche body measure anna.glb --unit in", [options](const Common& common, Report& report) {
        return run_measure(*options, common, report);
      });
  add_body_option(*verb, options->body);
  verb->add_flag("--list", options->list, "Name the measures and stop");
  CLI::Option* json = verb->add_flag("--json", options->json, "As JSON: metres and kilograms");
  CLI::Option* csv =
      verb->add_flag("--csv", options->csv, "As CSV: id, value, unit")->excludes(json);
  verb->add_option("--html", options->html,
                   "Write a page instead, with pictures of where the tapes lie")
      ->excludes(json)
      ->excludes(csv);
  verb->add_option("--unit", options->unit, "Of lengths")
      ->check(one_of({"m", "cm", "mm", "in", "ft"}))
      ->excludes(json)
      ->capture_default_str();
  add_skin_unit_option(*verb, "--skin-unit", options->skin_unit);
}

}  // namespace ecorche
