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

// --activation: for read_activation_table() and open_activations().
void add_activation_option(CLI::App& verb, std::string& source);

// Of a file (read_activations), whose muscles may have the names that the muscle table lists for
// comparison; none for "none" and "auto". Before a character is compiled. Throws InputError.
Activations read_activation_table(const Assets& assets, const std::string& source,
                                  const Anatomy& anatomy);

// "none": no activations. "auto": auto_activations of the motion. Otherwise those that
// read_activation_table() has read. Figures go to the report under `activation`.
Activations open_activations(const std::string& source, Activations table,
                             const CharacterModel& model, const Motion& motion, Report& report);

// How far muscles give what joints ask for, under `activation`.
void report_efforts(const MuscleEfforts& efforts, const Skeleton& skeleton, Report& report);

}  // namespace ecorche
