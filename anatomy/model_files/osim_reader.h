// OpenSim models (.osim). Private to model_reader, whose exceptions it throws.
#pragma once

#include <string>

#include "anatomy/model_files/musculoskeletal_model.h"

namespace ecorche::inline v1 {

// `text`: of the file, `name` stands for it in messages.
MusculoskeletalModel parse_osim(const std::string& text, const std::string& name);

}  // namespace ecorche::inline v1
