#include "app/files/character_file.h"

#include <map>

#include "anatomy/errors.h"
#include "skinning/files/light_character.h"

namespace ecorche {
namespace {

const std::map<std::string, Detail> kDetails{{"full", Detail::full}, {"light", Detail::light}};

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
           Detail detail, const Motion* motion, const CharacterLook& look) {
  detail == Detail::light ? write_light_character(file, character, binding, motion, look)
                          : write_character(file, character, binding, motion, look);
}

void write_with(const std::filesystem::path& file, const Actor& actor, Detail detail,
                const BodyPackage* package, const Motion* motion) {
  const auto look_of = [&](const Character& character) {
    const Skeleton& skeleton = character.anatomy.skeleton;
    return package ? find_look(*package, character.body.skin, skeleton)
                   : find_look(character.body.skin, skeleton);
  };
  const std::optional<BaseSkin> base =
      detail == Detail::light ? find_base(actor.character.body.skin) : std::nullopt;
  if (!base)
    return write(file, actor.character, actor.binding, detail, motion, look_of(actor.character));
  Character character = actor.character;
  Binding binding = actor.binding;
  make_coarse(*base, character, binding);
  write(file, character, binding, detail, motion, look_of(character));
}

}  // namespace

void add_detail_option(CLI::App& verb, Detail& detail) {
  verb.add_option("--detail", detail,
                  "Of a .glb: full (every bone and muscle by name; reads back as a character), or "
                  "light (four meshes, some 145,000 triangles, a dozen draw "
                  "calls; for looking at only)")
      ->transform(CLI::CheckedTransformer(kDetails))
      ->default_str("full");
}

void write_character_file(const std::filesystem::path& file, const Actor& actor, Detail detail,
                          const BodyPackage& package, const Motion* motion) {
  write_with(file, actor, detail, &package, motion);
}

void write_character_file(const std::filesystem::path& file, const Actor& actor, Detail detail,
                          const Motion* motion) {
  write_with(file, actor, detail, nullptr, motion);
}

}  // namespace ecorche
