#include "app/verbs/template/template_resample.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <array>
#include <filesystem>
#include <memory>

#include "anatomy/authoring/muscle_ends.h"
#include "anatomy/authoring/resample_mesh.h"
#include "anatomy/base_mesh/skin_import.h"
#include "anatomy/errors.h"
#include "anatomy/files/text_scanner.h"
#include "anatomy/mesh_files/mesh_io.h"
#include "app/options/option_values.h"
#include "app/options/subject_options.h"

namespace ecorche {
namespace {

struct Flags {
  std::filesystem::path mesh, output;
  std::string origin, insertion, unit = "auto";
  ResampleOptions options;
  bool json = false;
};

Vec3 parse_point(const std::string& text, const char* name) {
  Vec3 out;
  std::string_view rest = text;
  for (int k = 0; k < 3; ++k) {
    const auto comma = rest.find(',');
    if ((comma == std::string_view::npos) != (k == 2) ||
        !parse_number(rest.substr(0, comma), out[k])) {
      throw UsageError(
          fmt::format("--{} '{}': expected three numbers x,y,z in the mesh's units", name, text));
    }
    if (k < 2) rest.remove_prefix(comma + 1);
  }
  return out;
}

// Metres in one unit of the mesh. No muscle is longer than a metre, none is measured in kilometres.
double unit_of(const Flags& flags, const TriMesh& mesh, const Common& common) {
  if (const std::optional<double> given = metres_in(flags.unit)) return *given;
  const double size = (mesh.V.colwise().maxCoeff() - mesh.V.colwise().minCoeff()).norm();
  const double unit = size <= 1.2 ? 1 : 0.001;
  note(common, fmt::format("{}: {:g} units long, read as {}; --unit says otherwise",
                           flags.mesh.string(), size, unit == 1 ? "metres" : "millimetres"));
  return unit;
}

void fill_resample(const Resampled& result, Report& report) {
  const ResampleReport& r = result.report;
  report.set("action_line_length", r.length);
  report.set("slices", int(result.slices.size()));
  report.set("rays", r.rays);
  report.set("missed_rays", r.missed_rays);
  report.set("empty_slices", r.empty_slices);
  report.set("forked", r.forked);
  report.set("hidden", r.hidden);
  report.set_flag("mesh_closed", r.mesh_closed);
  report.set("mesh_volume", r.mesh_volume);
  report.set("loft_volume", r.loft_volume);
  report.set("volume_error", r.volume_error());
  report.set("mean_distance", r.mean_distance());
  report.set("mean_distance_loft_to_mesh", r.loft_to_mesh.mean);
  report.set("mean_distance_mesh_to_loft", r.mesh_to_loft.mean);
  report.set("max_distance_loft_to_mesh", r.loft_to_mesh.max);
  report.set("max_distance_mesh_to_loft", r.mesh_to_loft.max);
}

void print_table(const Resampled& result) {
  const ResampleReport& r = result.report;
  fmt::print("{} slices along {:.1f} mm; volume {:.2f} ml, mesh {:.2f} ml{} ({:+.1f} %)\n",
             result.slices.size(), 1e3 * r.length, 1e6 * r.loft_volume, 1e6 * r.mesh_volume,
             r.mesh_closed ? "" : " (open)", 100 * r.volume_error());
  fmt::print(
      "distance   mean mm   max mm\nloft-mesh  {:7.2f}  {:7.2f}\nmesh-loft  {:7.2f}  {:7.2f}\n\n",
      1e3 * r.loft_to_mesh.mean, 1e3 * r.loft_to_mesh.max, 1e3 * r.mesh_to_loft.mean,
      1e3 * r.mesh_to_loft.max);
  fmt::print("slice   centre x, y, z mm            half width  half thickness mm\n");
  for (std::size_t k = 0; k < result.slices.size(); ++k) {
    const Ellipse& e = result.slices[k];
    fmt::print("{:5}  {:8.1f} {:8.1f} {:8.1f}  {:12.2f} {:14.2f}\n", k, 1e3 * e.center.x(),
               1e3 * e.center.y(), 1e3 * e.center.z(), 1e3 * e.radii.x(), 1e3 * e.radii.y());
  }
}

int run_resample(const Flags& flags, const Common& common, Report& report) {
  if (!flags.output.empty()) require_ending(flags.output, {".obj", ".ply"});
  check_outputs(common, {flags.output}, {flags.mesh});
  TriMesh mesh = read_mesh(flags.mesh);
  const double unit = unit_of(flags, mesh, common);
  mesh.V *= unit;
  if (flags.origin.empty() != flags.insertion.empty())
    throw UsageError("give both --origin and --insertion, or neither");
  const bool given = !flags.origin.empty();
  if (!given)
    note(common, "no ends given: looking for those from which the muscle comes back best");
  Resampled result;
  {
    const StageTimer timer(report, "resample");
    result = given
                 ? resample_muscle(mesh, unit * parse_point(flags.origin, "origin"),
                                   unit * parse_point(flags.insertion, "insertion"), flags.options)
                 : resample_muscle(mesh, flags.options);
  }
  fill_resample(result, report);
  if (!flags.output.empty()) {
    result.loft.V /= unit;
    flags.output.extension() == ".ply" ? write_ply(flags.output, result.loft)
                                       : write_obj(flags.output, result.loft);
  }
  if (flags.json) {
    fmt::print("{}", report.to_json());
  } else {
    print_table(result);
  }
  return 0;
}

}  // namespace

void add_template_resample(VerbRegistry& registry, CLI::App& template_verb) {
  auto flags = std::make_shared<Flags>();
  CLI::App* verb = add_verb(
      registry, template_verb, "resample",
      "Turn a muscle mesh into elliptic slices along an action line, and loft them back",
      "ecorche template resample biceps.obj --origin 0.17,1.42,0.03 --insertion 0.31,1.12,0.02 -o "
      "loft.obj",
      [flags](const Common& common, Report& report) {
        return run_resample(*flags, common, report);
      });
  verb->add_option("mesh", flags->mesh, "The muscle: OBJ, PLY or GLB")->required();
  verb->add_option("--origin", flags->origin, "Where the muscle begins: x,y,z in the mesh's units");
  verb->add_option("--insertion", flags->insertion, "Where it ends");
  verb->add_option("--unit", flags->unit, "Unit of the mesh; auto finds it out")
      ->check(one_of({"auto", "m", "dm", "cm", "mm", "in", "ft"}));
  verb->add_option("--control-points", flags->options.control_points,
                   "Free controls of the action line")
      ->check(between(0, 12));
  verb->add_option("--slices", flags->options.slices, "Slices along it")->check(between(3, 200));
  verb->add_option("--rays", flags->options.rays, "Rays a slice")->check(between(8, 1000));
  verb->add_option("-o,--output", flags->output, "Write the lofted muscle to this OBJ or PLY file");
  add_json_option(*verb, flags->json);
}

}  // namespace ecorche
