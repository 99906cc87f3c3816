// Export models as files of MuJoCo (MJCF .xml).
#pragma once

#include <filesystem>

#include "anatomy/model_files/model_export.h"

namespace ecorche::inline v1 {

// Writes MODEL and, beside it, the folder `<stem>_meshes` with the bones as OBJ (none when
// `model.meshes` is empty). Throws OutputError.
ExportLosses write_mjcf(const std::filesystem::path& file, const ExportModel& model);

}  // namespace ecorche::inline v1
