// Characters written for other programs, in full or for looking at only. Shared by the verbs that
// write them.
#pragma once

#include <filesystem>

#include "anatomy/base_mesh/base_skin.h"
#include "anatomy/base_mesh/body_package.h"
#include "anatomy/character.h"
#include "anatomy/files/assets.h"
#include "anatomy/skeleton.h"
#include "skinning/binding.h"
#include "skinning/files/clip_shapes.h"

namespace CLI {
class App;
}

namespace ecorche {

enum class Detail {
  full,    // every bone and muscle by name; reads back
  medium,  // for looking at only: skinning/files/light_character.h
  low
};

// --detail
void add_detail_option(CLI::App& verb, Detail& detail);

// With texture and eyes, where the skin is the body package's; with a motion where there is one,
// and its shapes where it was recorded. A light file has the base mesh's skin even where the
// character's is the fine one. Throws OutputError.
void write_character_file(const Assets& assets, const std::filesystem::path& file,
                          const Character& character, const Binding& binding, Detail detail,
                          const BodyPackage& package, const Motion* motion = nullptr);

// The same with the package that is installed; without texture and eyes where there is none.
void write_character_file(const Assets& assets, const std::filesystem::path& file,
                          const Character& character, const Binding& binding, Detail detail,
                          const Motion* motion = nullptr, const ClipShapes* shapes = nullptr);

}  // namespace ecorche
