// Skins whose weights were set by hand (--weights), shared by the verbs that move a character.
#pragma once

#include <filesystem>

#include <CLI/CLI.hpp>

#include "app/actor.h"

namespace ecorche {

void add_weights_option(CLI::App& verb, std::filesystem::path& weights);

// Binds the actor's skin anew with the table's weights (docs/posebook.md); nothing for an empty path. What the table says goes to the report
// under `weights`. Throws InputError (see read_painted_weights).
void paint_skin(const std::filesystem::path& weights, Actor& actor, Report& report);

}  // namespace ecorche
