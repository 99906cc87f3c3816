#include "app/files/open_character.h"

#include <fmt/format.h>

#include "anatomy/bones/own_joints.h"
#include "anatomy/files/input_file.h"
#include "anatomy/files/package_archive.h"
#include "morph/fit/fit_character.h"
#include "skinning/crowd/crowd_read.h"

namespace ecorche {

Character open_character(const std::filesystem::path& file, const Common& common, Report& report) {
  if (!crowd_address(file)) {
    Character character = read_character(file);
    require_own_joints(character.anatomy.skeleton, printable(file.string()));
    return character;
  }
  note(common,
       fmt::format("{}: fitting bones and muscles; `ecorche fit '{}' -o FILE.glb` keeps them",
                   file.string(), file.string()));
  const BodyPackage package = read_body_package(find_packages());
  return fit_character(read_template(), read_body(file), package,
                       {.moves = false, .bound = false, .tissues = false}, report)
      .actor.character;
}

}  // namespace ecorche
