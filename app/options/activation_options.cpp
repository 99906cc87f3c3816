#include "app/options/activation_options.h"

#include <algorithm>

#include "anatomy/authoring/muscle_table.h"
#include "anatomy/files/package_archive.h"
#include "skinning/dynamics/static_optimization.h"

namespace ecorche {
namespace {

MuscleAliases other_names() {
  MuscleAliases aliases;
  for (const TableMuscle& muscle : read_muscle_table(data_folder()).muscles)
    for (const std::string& theirs : muscle.compare) aliases.emplace_back(theirs, muscle.name);
  return aliases;
}

}  // namespace

Activations open_activations(const std::string& source, const Actor& actor, const Motion& motion,
                             Report& report) {
  if (source == "none") return {};
  const Anatomy& anatomy = actor.character.anatomy;
  Activations activations;
  if (source == "auto") {
    const StageTimer timer(report, "activation");
    AutoActivationReport found;
    activations = auto_activations(actor.table, anatomy, actor.character.body, motion, found);
    report.set("activation.samples", found.samples);
    report.set("activation.reserve_share", found.reserve_share);
    report.set("activation.ground_force_peak", found.ground_force_peak);
  } else {
    activations = read_activations(source, anatomy, other_names());
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
