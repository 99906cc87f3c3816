#include "app/verbs/template/template_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <map>

#include "anatomy/errors.h"
#include "app/files/template_file.h"
#include "app/options/subject_options.h"
#include "app/verbs/template/template_import.h"
#include "app/verbs/template/template_resample.h"
#include "app/verbs/template/template_sweep.h"
#include "morph/template/template.h"
#include "morph/template/template_check.h"

namespace ecorche {
namespace {

void report_check(const TemplateCheck& check, Report& report) {
  report.set("template.muscle_ends", check.ends);
  report.set("template.end_distance_median", check.end_distance_median);
  report.set("template.end_distance_max", check.end_distance_max);
  report.set("template.loose_ends", int(check.loose_ends.size()));
  report.set("template.mirror_bones_max", check.mirror_bones_max);
  report.set("template.mirror_muscles_max", check.mirror_muscles_max);
  report.set("template.volume_error_max", check.volume_error_max);
  report.set_flag("template.passed", check.passed());
}

void fill_template(const Template& tmpl, Report& report) {
  const Anatomy& anatomy = tmpl.anatomy;
  int strips = 0;
  double volume = 0;
  for (const Muscle& muscle : anatomy.muscles) {
    strips += muscle.strips.size();
    volume += muscle.volume;
  }
  report.set("bones", int(anatomy.bones.size()));
  report.set("joints", int(anatomy.skeleton.joints.size()));
  report.set("muscles", int(anatomy.muscles.size()));
  report.set("strips", strips);
  report.set("slices", slice_count(anatomy));
  report.set("muscle_volume", volume);
  report.set("skin_vertices", int(tmpl.body.skin.V.rows()));
}

struct TemplateFlags {
  bool json = false;
  std::filesystem::path file;  // empty: the built-in template
};

int run_info(const TemplateFlags& flags, const Common& common, Report& report) {
  const Template tmpl = open_template(common.assets, flags.file);
  fill_template(tmpl, report);
  if (flags.json) {
    fmt::print("{}", report.to_json());
    return 0;
  }
  fmt::print(
      "{} bones on {} joints, {} muscles of {} strips and {} slices, {:.1f} l of muscle, skin of "
      "{} vertices\n\n",
      tmpl.anatomy.bones.size(), tmpl.anatomy.skeleton.joints.size(), tmpl.anatomy.muscles.size(),
      report.number("strips"), report.number("slices"), 1e3 * report.number("muscle_volume"),
      tmpl.body.skin.V.rows());
  std::map<std::string, std::pair<int, double>> groups;
  for (const Muscle& muscle : tmpl.anatomy.muscles) {
    ++groups[muscle.group].first;
    groups[muscle.group].second += muscle.volume;
  }
  fmt::print("{:<20} {:>8} {:>10}\n", "region", "muscles", "litres");
  for (const auto& [name, sum] : groups)
    fmt::print("{:<20} {:>8} {:>10.2f}\n", name, sum.first, 1e3 * sum.second);
  return 0;
}

int run_check(const TemplateFlags& flags, const Common& common, Report& report) {
  const Template tmpl = open_template(common.assets, flags.file);
  fill_template(tmpl, report);
  const TemplateCheck check = check_template(tmpl, common.assets.tables);
  report_check(check, report);
  if (flags.json)
    fmt::print("{}", report.to_json());
  else
    fmt::print("{}", format_check(check));
  return check.passed() ? 0 : 8;
}

}  // namespace

void add_template_verb(VerbRegistry& registry) {
  CLI::App* verb =
      registry.app.add_subcommand("template", "The built-in anatomy, and tools for making one");
  verb->require_subcommand(1);
  auto flags = std::make_shared<TemplateFlags>();
  CLI::App* info = add_verb(
      registry, *verb, "info", "Say what the template holds", "ecorche template info",
      [flags](const Common& common, Report& report) { return run_info(*flags, common, report); });
  add_json_option(*info, flags->json);
  CLI::App* check = add_verb(
      registry, *verb, "check",
      "Check the template against its promises; exit code 8 if one is broken",
      "ecorche template check --report check.json",
      [flags](const Common& common, Report& report) { return run_check(*flags, common, report); });
  add_json_option(*check, flags->json);
  for (CLI::App* one : {info, check}) add_template_option(*one, "template", flags->file);
  add_template_import(registry, *verb);
  add_template_resample(registry, *verb);
  add_template_sweep(registry, *verb);
}

}  // namespace ecorche
