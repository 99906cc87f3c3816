// A character with few triangles and few draw calls, for display in web pages, previews and
// engines.
//
// Mesh nodes `skin`, `bones`, `muscles` and `eyes`, each a mesh with a primitive a tissue, all
// moved by the joints. With shapes of a motion the muscles are a mesh a region, `muscles/thigh_l`,
// since morph targets are of whole meshes. Bones and muscles are simplified. The vertex attribute
// _PART is the index of the bone or muscle in the node's extras `parts`. The file says how light it
// is, `"detail": "low"`, and read_character refuses it; its body reads back.
#pragma once

#include <filesystem>

#include "anatomy/character.h"
#include "skinning/binding.h"
#include "skinning/files/character_look.h"
#include "skinning/files/clip_shapes.h"

namespace ecorche::inline v1 {

struct LightDetail {
  const char* name = "medium";
  int bones = 44000, muscles = 74000;  // triangles
  int least = 60;                      // of a bone or muscle, where it has them
};
inline constexpr LightDetail kMediumDetail{};
inline constexpr LightDetail kLowDetail{"low", 12000, 18500, 24};

// As write_character. The skin is written as it is: give the base mesh's.
void write_light_character(const std::filesystem::path& file, const Character& character,
                           const Binding& binding, const LightDetail& detail = kMediumDetail,
                           const Motion* motion = nullptr, const CharacterLook& look = {},
                           const ClipShapes* shapes = nullptr);

}  // namespace ecorche::inline v1
