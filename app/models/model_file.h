// Musculoskeletal models of characters for other programs: OpenSim (.osim), MuJoCo (.xml).
#pragma once

#include <filesystem>

#include "anatomy/character.h"
#include "anatomy/model_files/model_export.h"
#include "app/common_options.h"
#include "app/report.h"

namespace ecorche {

struct ModelFileOptions {
  bool weighed = true;  // masses of the body's own tissues; else those of the table
  bool meshes = true, ground = false;
};

// Warns of masses that its skin does not give, and of muscles that do not say how strong they are.
ExportModel model_of(const Character& character, const ModelFileOptions& options,
                     const Common& common, Report& report);

// By its ending; bones go to NAME_meshes beside it. Precondition: .osim or .xml. Throws
// OutputError.
void write_model_file(const std::filesystem::path& file, const ExportModel& model,
                      const Common& common, Report& report);

}  // namespace ecorche
