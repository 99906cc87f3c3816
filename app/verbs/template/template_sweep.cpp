#include "app/verbs/template/template_sweep.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <array>
#include <numbers>

#include "anatomy/authoring/muscle_placement.h"
#include "anatomy/authoring/muscle_table.h"
#include "anatomy/bones/bone_package.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/posing/joint_sweep.h"
#include "app/options/option_values.h"
#include "app/progress.h"

namespace ecorche {
namespace {
constexpr double kStill = 0.1e-3;  // m: a line that changes by less does not cross the joint
constexpr std::array kAxes{"flexion", "abduction", "rotation"};

struct SweepFlags {
  std::filesystem::path output;
  double step = 5;  // degrees
};

int run_sweep(const SweepFlags& flags, const Common& common, Report& report) {
  check_outputs(common, {flags.output});
  Anatomy anatomy = read_source_skeleton(common.assets);
  anatomy.muscles = place_muscles(read_muscle_table(common.assets.tables), anatomy);
  const PosingTable table = make_posing_table(anatomy);
  const auto ranges = slice_ranges(anatomy);
  const auto sweeps = joint_sweeps(anatomy.skeleton, flags.step * kDegree);
  std::string rows = "joint,axis,angle_deg,muscle,strip,length_mm\n";
  int lines = 0;
  Progress progress(common, "sweeps", int(sweeps.size()));
  for (const JointSweep& sweep : sweeps) {
    const Eigen::MatrixXd lengths = swept_lengths(table, anatomy.skeleton, sweep);
    for (size_t i = 0; i < ranges.size(); ++i) {
      const auto of = lengths.col(i);
      if (of.maxCoeff() - of.minCoeff() < kStill) continue;
      ++lines;
      for (size_t k = 0; k < sweep.angles.size(); ++k)
        rows +=
            fmt::format("{},{},{:.6f},{},{},{:.4f}\n", anatomy.skeleton.joints[sweep.joint].name,
                        kAxes[sweep.axis], sweep.angles[k] / kDegree,
                        anatomy.muscles[ranges[i].muscle].name, ranges[i].strip, 1e3 * of[k]);
    }
    progress.step();
  }
  write_file_atomically(flags.output, rows);
  report.set("sweeps", int(sweeps.size()));
  report.set("lines", lines);
  return 0;
}

}  // namespace

void add_template_sweep(VerbRegistry& registry, CLI::App& template_verb) {
  auto flags = std::make_shared<SweepFlags>();
  CLI::App* verb = add_verb(
      registry, template_verb, "sweep",
      "Write the lengths of the muscles' lines while one joint after the other turns, on the bone "
      "package's skeleton",
      "ecorche template sweep -o sweeps.csv",
      [flags](const Common& common, Report& report) { return run_sweep(*flags, common, report); });
  verb->add_option("--step", flags->step, "Degrees from one angle to the next, at most")
      ->check(between(0.5, 45.0));
  verb->add_option("-o,--output", flags->output,
                   "The CSV file: joint, axis, degrees from the anatomical zero, muscle, strip, "
                   "mm; lines that change by 0.1 mm or more")
      ->required();
}

}  // namespace ecorche
