// A superficial vein as it runs on a skin.
#pragma once

#include <string>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct VeinPath {
  std::string name;          // "cephalic_l"
  std::vector<Vec3> points;  // on the skin at rest, in order, world, m
  double width = 0;          // m, standard deviation of the ridge's profile
  double height = 0;         // m, of the ridge where nothing but skin is over it, in effort
};

}  // namespace ecorche::inline v1
