#include "app/files/open_character.h"

#include <fmt/format.h>

#include "anatomy/bones/own_joints.h"
#include "anatomy/files/input_file.h"
#include "app/files/fitted_actor.h"
#include "morph/template/template_cache.h"
#include "skinning/crowd/crowd_read.h"
#include "skinning/files/character_read.h"

namespace ecorche {

Character open_character(const std::filesystem::path& file, const Common& common, Report& report) {
  const std::optional<CrowdAddress> one = crowd_address(file);
  if (!one) {
    Character character = read_character(file);
    require_own_joints(common.assets.tables, character.anatomy.skeleton, printable(file.string()));
    return character;
  }
  note(common,
       fmt::format("{}: fitting bones and muscles; `ecorche fit '{}' -o FILE.glb` keeps them",
                   file.string(), file.string()));
  const BodyPackage package = read_body_package(common.assets);
  const CrowdPerson person = read_crowd_person(open_crowd(one->file), one->person);
  return fit_unbound(read_template(common.assets), person.body, package, {.tissues = false},
                     report);
}

}  // namespace ecorche
