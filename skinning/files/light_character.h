// A character in few triangles and few draw calls, for web pages, previews and engines: for looking
// at only.
//
// Mesh nodes `skin`, `bones`, `muscles` and `eyes`, each a mesh with a primitive a tissue, all
// moved by the joints. Bones and muscles are simplified to kLightBones and kLightMuscles triangles.
// Their vertices say by _PART which bone or muscle they are of: its place in the node's extras
// `parts`. The file says `"detail": "light"`, and read_character refuses it; its body reads back.
#pragma once

#include <filesystem>

#include "skinning/files/character_io.h"

namespace ecorche {

inline constexpr int kLightBones = 44000, kLightMuscles = 74000;  // triangles

// As write_character. The skin is written as it is: give the base mesh's.
void write_light_character(const std::filesystem::path& file, const Character& character,
                           const Binding& binding, const Motion* motion = nullptr,
                           const CharacterLook& look = {});

}  // namespace ecorche
