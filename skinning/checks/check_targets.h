// Targets that an anatomy's quality figures have to meet.
#pragma once

#include <string>
#include <vector>

#include "skinning/checks/anatomy_check.h"

namespace ecorche::inline v1 {

// A figure beside the value asked of it, as text.
struct Target {
  std::string what, asked, measured;
  bool met = false;
};
// Targets of the figures that were measured.
std::vector<Target> check_targets(const AnatomyCheck& check);

}  // namespace ecorche::inline v1
