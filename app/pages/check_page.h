// Results of a check: a table for the terminal, a CSV file by muscle, a page with pictures.
#pragma once

#include <string>
#include <vector>

#include "app/files/actor.h"
#include "skinning/checks/anatomy_check.h"
#include "skinning/checks/bulges.h"
#include "skinning/checks/check_targets.h"

namespace ecorche {

std::string check_table(const std::vector<Target>& targets);  // asked, measured, met
std::string slits_row(const AnatomyCheck& check);  // of that table; nothing is asked of them
std::string check_csv(const AnatomyCheck& check, const Anatomy& anatomy);  // a row a muscle

struct CheckPageOptions {
  std::string title;
  bool pictures = true;
};
// Pictures: muscles coloured by their overlap with others at rest, and the worst poses. Throws
// OutputError if nothing can be drawn.
std::string check_page(const AnatomyCheck& check, const std::vector<Target>& targets,
                       const Bulges& bulges, const Actor& actor,
                       const std::vector<LimitPose>& poses, const CheckPageOptions& options);

}  // namespace ecorche
