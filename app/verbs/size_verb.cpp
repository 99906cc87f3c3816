#include "app/verbs/size_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cmath>

#include "anatomy/errors.h"
#include "app/files/open_body.h"
#include "app/options/option_values.h"
#include "app/options/subject_options.h"
#include "morph/shapes/shape_space_cache.h"
#include "morph/shapes/sizes.h"

namespace ecorche {
namespace {

int run_size(const std::filesystem::path& file, const std::string& sex, const std::string& unit,
             const Common& common, Report& report) {
  check_outputs(common, {}, {file});
  const BodyPackage package = read_body_package(common.assets);
  const TapeMeasure tape(package, read_measure_table(package, package.tables / "body"));
  Body body = open_base_body(file, package, common, report, unit);
  if (!sex.empty()) body.sex = sex == "female" ? Sex::female : Sex::male;
  const std::vector<SizeFigure> own = size_figures(tape, package, body.skin.V);
  const BodyFeatures features = find_features(body.skin);
  const ShapeSpace space = read_shape_space(package, tape, body.sex);
  std::vector<SizeFigure> nearest;
  std::string name;
  double least = 0;
  for (const StandardSize& size : read_sizes(common.assets.tables / "body")) {
    if (size.sex != body.sex) continue;
    const SolvedBody standard = solve_measures(tape, space, size_targets(size, tape.table()));
    const std::vector<SizeFigure> figures = size_figures(tape, package, standard.points);
    const double distance = size_distance(own, figures);
    report.set("size.distance." + size.name, std::sqrt(distance));
    if (name.empty() || distance < least) least = distance, name = size.name, nearest = figures;
  }
  report.set("size.nearest", name);
  fmt::print("size {}\n\n{:20} {:>9} {:>9} {:>11}\n", name, "cm", "body", "size", "alteration");
  for (std::size_t i = 0; i < own.size(); ++i) {
    const double change = own[i].value - nearest[i].value;
    report.set("size.figures." + own[i].name, own[i].value);
    report.set("size.alteration." + own[i].name, change);
    fmt::print("{:20} {:>9.1f} {:>9.1f} {:>+11.1f}\n", own[i].name, 100 * own[i].value,
               100 * nearest[i].value, 100 * change);
  }
  fmt::print("\n{:20} {:>9}\n", "feature point", "height");
  for (const auto& [what, height] : {std::pair{"armpit, left", features.armpit_left.y()},
                                     {"armpit, right", features.armpit_right.y()},
                                     {"bust", features.bust.height},
                                     {"waist", features.waist.height},
                                     {"hip", features.hip.height},
                                     {"crotch", features.crotch_height}})
    fmt::print("{:20} {:>9.1f}\n", what, 100 * height);
  return 0;
}

}  // namespace

void add_body_size(VerbRegistry& registry, CLI::App& body) {
  struct Options {
    std::filesystem::path body;
    std::string sex, unit;
  };
  auto options = std::make_shared<Options>();
  CLI::App* verb =
      add_verb(registry, body, "size",
               "Find the clothing size nearest to a body, and how it must be altered",
               "ecorche body size anna.glb", [options](const Common& common, Report& report) {
                 return run_size(options->body, options->sex, options->unit, common, report);
               });
  add_body_option(*verb, options->body)->required();
  add_sex_option(*verb, options->sex, "Sizes for male or female; the body's own when left out");
  add_skin_unit_option(*verb, "--skin-unit", options->unit);
}

}  // namespace ecorche
