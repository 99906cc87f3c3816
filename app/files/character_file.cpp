#include "app/files/character_file.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <map>
#include <optional>

#include "anatomy/errors.h"
#include "skinning/files/character_write.h"
#include "skinning/files/light_character.h"

namespace ecorche {
namespace {

const std::map<std::string, Detail> kDetails{
    {"full", Detail::full}, {"medium", Detail::medium}, {"low", Detail::low}};

// The character in the skin that its fine one was refined from.
void make_coarse(const BaseSkin& base, Character& character, Binding& binding) {
  Binding coarse;
  for (const int row : base.refinement.base_rows) {
    coarse.anchors.push_back(binding.anchors[row]);
    coarse.joint_weights.push_back(binding.joint_weights[row]);
  }
  coarse.vertex_count = base.mesh.V.rows();
  binding = std::move(coarse);
  character.body.skin = base.mesh;
}

void write(const std::filesystem::path& file, const Character& character, const Binding& binding,
           Detail detail, const Motion* motion, const CharacterLook& look,
           const ClipShapes* shapes) {
  if (detail == Detail::full)
    return write_character(file, character, binding, motion, look, shapes);
  write_light_character(file, character, binding,
                        detail == Detail::low ? kLowDetail : kMediumDetail, motion, look, shapes);
}

void write_with(const Assets& assets, const std::filesystem::path& file, const Character& character,
                const Binding& binding, Detail detail, const BodyPackage* package,
                const Motion* motion, const ClipShapes* shapes) {
  const auto look_of = [&](const Character& shown) {
    const Skeleton& skeleton = shown.anatomy.skeleton;
    return package ? find_look(*package, shown.body.skin, skeleton)
                   : find_look(assets, shown.body.skin, skeleton);
  };
  if (character.own && detail != Detail::full)
    throw UnfitError(
        fmt::format("{}: --detail medium and low are for our own skins; a character in a skin of "
                    "its own is written in full, leave the option out",
                    file.string()));
  const std::optional<BaseSkin> base =
      detail != Detail::full ? find_base(assets, character.body.skin) : std::nullopt;
  if (!base) return write(file, character, binding, detail, motion, look_of(character), shapes);
  Character coarse = character;
  Binding coarse_binding = binding;
  make_coarse(*base, coarse, coarse_binding);
  if (!shapes) return write(file, coarse, coarse_binding, detail, motion, look_of(coarse), nullptr);
  const ClipShapes coarse_shapes = clip_on_rows(*shapes, base->refinement.base_rows);
  write(file, coarse, coarse_binding, detail, motion, look_of(coarse), &coarse_shapes);
}

}  // namespace

void add_detail_option(CLI::App& verb, Detail& detail) {
  verb.add_option("--detail", detail,
                  "Of a .glb: full (every bone and muscle by name; reads back as a character); for "
                  "looking at only, in few draw calls: medium (some 145,000 triangles), low (under "
                  "60,000)")
      ->transform(CLI::CheckedTransformer(kDetails))
      ->default_str("full");
}

void write_character_file(const Assets& assets, const std::filesystem::path& file,
                          const Character& character, const Binding& binding, Detail detail,
                          const BodyPackage& package, const Motion* motion) {
  write_with(assets, file, character, binding, detail, &package, motion, nullptr);
}

void write_character_file(const Assets& assets, const std::filesystem::path& file,
                          const Character& character, const Binding& binding, Detail detail,
                          const Motion* motion, const ClipShapes* shapes) {
  write_with(assets, file, character, binding, detail, nullptr, motion, shapes);
}

}  // namespace ecorche
