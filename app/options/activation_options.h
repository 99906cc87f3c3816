// How hard the muscles work, as told on the command line.
#pragma once

#include <string>

#include "skinning/character/character_model.h"
#include "skinning/motion/activation.h"

namespace ecorche {

inline constexpr const char* kActivationHelp =
    "How hard muscles work: none; auto (read off the motion); or a table: CSV with columns "
    "time,muscle,value or time and a column a muscle, "
    "or an OpenSim .sto/.mot";

// "none": nothing. "auto": auto_activations of the motion. Anything else: a file, see
// read_activations; other people's names are those that the muscle table compares its muscles with.
// What was found goes to the report under `activation`. Throws InputError.
Activations open_activations(const std::string& source, const Actor& actor, const Motion& motion,
                             Report& report);

}  // namespace ecorche
