// Writes characters and bodies as .glb (character_format.h).
#pragma once

#include <filesystem>

#include "anatomy/character.h"
#include "skinning/binding.h"
#include "skinning/files/character_look.h"
#include "skinning/files/clip_shapes.h"

namespace ecorche::inline v1 {

// With a motion, the file holds it as one animation named `motion`, a key a frame; with its shapes,
// skin and muscles move as those were recorded, otherwise by joints alone. Binding, motion and
// shapes must belong to the character (std::invalid_argument otherwise). Throws OutputError.
void write_character(const std::filesystem::path& file, const Character& character,
                     const Binding& binding, const Motion* motion = nullptr,
                     const CharacterLook& look = {}, const ClipShapes* shapes = nullptr);

// A body without anatomy: the mesh node `skin` and the body's notes (name, sex, age, mass,
// landmarks). Throws OutputError.
void write_body(const std::filesystem::path& file, const Body& body);

}  // namespace ecorche::inline v1
