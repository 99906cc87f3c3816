#include "app/files/template_file.h"

#include <fmt/format.h>

#include "anatomy/character.h"
#include "anatomy/errors.h"
#include "morph/template/template_cache.h"
#include "skinning/crowd/crowd_read.h"
#include "skinning/files/character_read.h"

namespace ecorche {

Template open_template(const Assets& assets, const std::filesystem::path& file) {
  if (file.empty()) return read_template(assets);
  refuse_crowd(file);
  Character character = read_character(file);  // first: the built-in one may have to be made
  Template built_in = read_template(assets);
  const auto &own = character.anatomy.skeleton.joints, &known = built_in.anatomy.skeleton.joints;
  for (size_t j = 0; j < std::max(own.size(), known.size()); ++j) {
    if (j >= own.size() || j >= known.size() || own[j].name != known[j].name ||
        own[j].parent != known[j].parent)
      throw UnfitError(
          fmt::format("{}: its joints are not those of the built-in template; make it anew with "
                      "`ecorche template import`",
                      file.string()));
    // A template lies in the default body; a character in any other one is no template.
    if ((own[j].X_PJ.translation() - known[j].X_PJ.translation()).norm() > 1e-4)
      throw UnfitError(
          fmt::format("{}: joint '{}' lies elsewhere than in the default body; is it a character "
                      "instead of a template?",
                      file.string(), own[j].name));
  }
  Template out{std::move(character.anatomy), std::move(built_in.body), std::move(built_in.tables)};
  out.anatomy.skeleton = built_in.anatomy.skeleton;  // the file has it in single precision
  out.tables.muscles = out.anatomy.muscles;          // fitting grows them to the skin
  out.tables.built_in = std::move(built_in.anatomy);
  return out;
}

}  // namespace ecorche
