// A document for other programs: a template to fit with, and musculoskeletal models.
#pragma once

#include <filesystem>

#include "app/common_options.h"
#include "app/edit/document/workshop.h"
#include "app/models/model_file.h"
#include "app/report.h"

namespace ecorche {

// The document's muscles in the template's own body, before they grow to its skin, as
// open_template() reads it. Throws UnfitError where joints or bones are otherwise than built in,
// which a template does not carry; OutputError.
void write_template_file(Workshop& workshop, const Document& document,
                         const std::filesystem::path& file, const Common& common, Report& report);

// The document's body, fitted, as a model.
void write_fitted_model(Workshop& workshop, const Document& document,
                        const std::filesystem::path& file, const ModelFileOptions& options,
                        const Common& common, Report& report);

}  // namespace ecorche
