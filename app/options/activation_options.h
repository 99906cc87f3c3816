// Muscle activations, as given on the command line.
#pragma once

#include <string>

#include "anatomy/files/assets.h"
#include "app/report.h"
#include "skinning/character/character_model.h"
#include "skinning/dynamics/static_optimization.h"
#include "skinning/motion/activation.h"

namespace CLI {
class App;
}

namespace ecorche {

// --activation: for open_activations().
void add_activation_option(CLI::App& verb, std::string& source);

// "none": no activations. "auto": auto_activations of the motion. Otherwise a file
// (read_activations), whose muscles may have the names that the muscle table lists for
// comparison. Figures go to the report under `activation`. Throws InputError.
Activations open_activations(const Assets& assets, const std::string& source,
                             const CharacterModel& model, const Motion& motion, Report& report);

// How far muscles give what joints ask for, under `activation`.
void report_efforts(const MuscleEfforts& efforts, const Skeleton& skeleton, Report& report);

}  // namespace ecorche
