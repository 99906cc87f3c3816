// Musculoskeletal models from files: OpenSim and MuJoCo.
#pragma once

#include <filesystem>

#include "anatomy/model_files/musculoskeletal_model.h"

namespace ecorche::inline v1 {

// Tells the format by the file's first element. `folder` holds everything that the model names;
// empty: the folder of the file. Nothing outside it is opened. Throws InputError that names file,
// part and value (malformed XML, unknown or missing parts, numbers that are not finite, cycles),
// LimitError (64 levels, 256 included files, 20,000 bodies, points or wraps), UnfitError for a
// model without bodies or muscles.
MusculoskeletalModel read_muscle_model(const std::filesystem::path& file,
                                       const std::filesystem::path& folder = {});

// Mesh of a body: OBJ, PLY, STL or ASCII VTP inside the folder; model scale applied, body frame.
// Empty when the file does not exist.
TriMesh read_model_mesh(const std::filesystem::path& folder, const ModelMesh& mesh);

}  // namespace ecorche::inline v1
