#include "app/files/template_file.h"

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "skinning/files/character_io.h"

namespace ecorche {

Template open_template(const std::filesystem::path& file) {
  Template built_in = read_template();
  if (file.empty()) return built_in;
  Character character = read_character(file);
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
  auto tables = std::make_shared<FitTables>(*built_in.tables);
  tables->muscles = character.anatomy.muscles;  // fitting grows them to the skin
  tables->own = std::make_shared<const Anatomy>(std::move(built_in.anatomy));
  Template out;
  out.anatomy = std::move(character.anatomy);
  out.anatomy.skeleton = tables->own->skeleton;  // the file has it in single precision
  out.body = std::move(built_in.body);
  out.tables = std::move(tables);
  return out;
}

}  // namespace ecorche
