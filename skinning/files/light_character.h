// A character with few triangles and few draw calls, for display in web pages, previews and
// engines.
//
// Mesh nodes `skin`, `bones`, `muscles` and `eyes`, each a mesh with a primitive a tissue, all
// moved by the joints. Bones and muscles are simplified to kLightBones and kLightMuscles triangles.
// The vertex attribute _PART is the index of the bone or muscle in the node's extras `parts`. The
// file says `"detail": "light"`, and read_character refuses it; its body reads back.
#pragma once

#include <filesystem>

#include "anatomy/character.h"
#include "skinning/binding.h"
#include "skinning/files/character_look.h"

namespace ecorche::inline v1 {

inline constexpr int kLightBones = 44000, kLightMuscles = 74000;  // triangles

// As write_character. The skin is written as it is: give the base mesh's.
void write_light_character(const std::filesystem::path& file, const Character& character,
                           const Binding& binding, const Motion* motion = nullptr,
                           const CharacterLook& look = {});

}  // namespace ecorche::inline v1
