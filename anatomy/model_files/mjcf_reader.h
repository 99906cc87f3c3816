// MuJoCo models (MJCF). Private to model_reader, whose exceptions it throws.
#pragma once

#include <string>

#include "anatomy/model_files/musculoskeletal_model.h"

namespace ecorche::inline v1 {

struct ModelFiles;  // model_xml.h

// `path`: of the model among `files`, which reads all files by their path relative to the model's
// folder.
MusculoskeletalModel parse_mjcf_model(const ModelFiles& files, const std::string& path);

}  // namespace ecorche::inline v1
