// What a check found, for people: a table on the screen, a CSV by muscle, a page with pictures.
#pragma once

#include <string>

#include "skinning/checks/anatomy_check.h"
#include "skinning/checks/bulges.h"

namespace ecorche {

std::string check_table(const std::vector<Target>& targets);               // asked, measured, met
std::string check_csv(const AnatomyCheck& check, const Anatomy& anatomy);  // a row a muscle

struct CheckPageOptions {
  std::string title;
  bool pictures = true;
};
// Pictures: muscles coloured by what they share with others at rest, and the worst poses. Throws
// OutputError where nothing can be drawn.
std::string check_page(const AnatomyCheck& check, const std::vector<Target>& targets,
                       const Bulges& bulges, const Actor& actor,
                       const std::vector<LimitPose>& poses, const CheckPageOptions& options);

}  // namespace ecorche
