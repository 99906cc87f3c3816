// From a document to a character: the template with its muscles and joints, its body, and the fit.
#pragma once

#include <vector>

#include "anatomy/character.h"
#include "app/common_options.h"
#include "app/edit/document/workshop.h"
#include "app/report.h"
#include "morph/fit/fit_character.h"
#include "morph/template/template.h"

namespace ecorche {

// The muscles of one entry, left and right, placed in the template's body before they grow. Joints
// are those of edited_source().
std::vector<Muscle> placed_entry(Workshop& workshop, const Document& document, int entry);

// The built-in template with the document's muscles and joints. Muscles that the document shares
// with the built-in one are taken over as they are. Throws InputError for what cannot be placed.
Template edited_template(Workshop& workshop, const Document& document);

// The body that muscles are fitted into: the file's or the template's, with the measures asked for.
// Throws as open_base_body, change_body.
Body edited_body(Workshop& workshop, const Document& document, const Common& common,
                 Report& report);

FittingOptions fitting_of(const Document& document);

// Whether the same character comes of both.
bool fits_alike(const Document& a, const Document& b);
// Or one that differs in muscles, in the same body on the same skeleton.
bool differs_in_muscles_alone(const Document& a, const Document& b);

}  // namespace ecorche
