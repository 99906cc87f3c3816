#include "app/options/activation_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>

#include "anatomy/authoring/muscle_table.h"
#include "skinning/dynamics/auto_activations.h"
#include "skinning/motion/activation_read.h"

namespace ecorche {
namespace {

MuscleAliases other_names(const Assets& assets) {
  MuscleAliases aliases;
  for (const TableMuscle& muscle : read_muscle_table(assets.tables).muscles)
    for (const std::string& theirs : muscle.compare) aliases.emplace_back(theirs, muscle.name);
  return aliases;
}

}  // namespace

void report_efforts(const MuscleEfforts& efforts, const Skeleton& skeleton, Report& report) {
  report.set("activation.samples", int(efforts.times.size()));
  report.set("activation.reserve_share", efforts.reserve_share);
  for (const JointReserve& joint : joint_reserves(efforts)) {
    const std::string key = "activation.joints." + skeleton.joints[joint.joint].name;
    report.set(key + ".moment", joint.wanted);
    report.set(key + ".reserve", joint.reserve);
  }
}

void add_activation_option(CLI::App& verb, std::string& source) {
  verb.add_option("--activation", source,
                  "How hard muscles work: none; auto (read off the motion); or a table: CSV with "
                  "columns time,muscle,value or time and a column a muscle, "
                  "or an OpenSim .sto/.mot")
      ->capture_default_str();
}

Activations read_activation_table(const Assets& assets, const std::string& source,
                                  const Anatomy& anatomy) {
  if (source == "none" || source == "auto") return {};
  return read_activations(source, anatomy, other_names(assets));
}

Activations open_activations(const std::string& source, Activations table,
                             const CharacterModel& model, const Motion& motion, Report& report) {
  if (source == "none") return {};
  const Anatomy& anatomy = model.character.anatomy;
  Activations activations = std::move(table);
  if (source == "auto") {
    const StageTimer timer(report, "activation");
    AutoActivations found = auto_activations(model.muscles.posing, anatomy, model.character.body,
                                             model.binding.joint_weights, motion);
    activations = std::move(found.activations);
    report_efforts(found.efforts, anatomy.skeleton, report);
    report.set("activation.ground_force_peak", found.ground_force_peak);
    report.set("activation.residual_force", found.residual_force);
    report.set("activation.masses", found.table_masses ? "table" : "tissues");
  }
  std::vector<char> driven(anatomy.muscles.size(), 0);
  double largest = 0;
  for (const ActivationCurve& curve : activations.curves) {
    for (int m : curve.muscles) driven[m] = 1;
    largest = std::max(largest, *std::max_element(curve.values.begin(), curve.values.end()));
  }
  report.set("activation.source", source);
  report.set("activation.muscles", int(std::count(driven.begin(), driven.end(), 1)));
  report.set("activation.largest", largest);
  return activations;
}

}  // namespace ecorche
