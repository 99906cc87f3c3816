#include "app/edit/model_outputs.h"

#include <fmt/format.h>

#include <utility>

#include "anatomy/errors.h"
#include "app/edit/document/edited_skeleton.h"
#include "app/edit/refit.h"
#include "app/files/actor.h"
#include "app/files/character_file.h"
#include "app/files/fitted_actor.h"

namespace ecorche {

void write_template_file(Workshop& workshop, const Document& document,
                         const std::filesystem::path& file, const Common& common, Report& report) {
  if (!document.joints->empty() || has_own_parts(document) || !document.skeleton->groups.empty())
    throw UnfitError(
        "joints and bones of this document differ from the built-in ones, which a template does "
        "not carry; save the project, and fit bodies in it");
  Template edited = edited_template(workshop, document);
  edited.anatomy.muscles = std::move(edited.tables.muscles);  // fitting grows them to the skin
  Body body = workshop.base().body;
  body.name = file.stem().string();
  const BoundCharacter bound =
      bind_character(common.assets, Character{std::move(edited.anatomy), std::move(body)}, report);
  write_character_file(common.assets, file, bound.character, bound.binding, Detail::full,
                       workshop.package());
  note(common, fmt::format("{}: a template of {} muscles, for `ecorche fit --template`",
                           file.string(), bound.character.anatomy.muscles.size()));
}

void write_fitted_model(Workshop& workshop, const Document& document,
                        const std::filesystem::path& file, const ModelFileOptions& options,
                        const Common& common, Report& report) {
  FittedActorOptions fitted;
  fitted.fitting = fitting_of(document);
  fitted.fitting.tissues = true;
  const Character character = fit_unbound(edited_template(workshop, document),
                                          edited_body(workshop, document, common, report),
                                          workshop.package(), fitted.fitting, report);
  write_model_file(file, model_of(character, options, common, report), common, report);
}

}  // namespace ecorche
