// Whether muscles end on the bones that carry their ends: what `fit` and `check` both ask for.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

inline constexpr double kLooseEnd = 0.010;  // m; farther off, an end is loose

struct MuscleEnds {
  // m, of all strips' ends on bones, from the bones of the joint that carries them; ascending
  std::vector<double> distances;
  std::vector<double> farthest;  // m, #muscles; nought where no end is on a bone
  int loose = 0;                 // ends
};

MuscleEnds measure_muscle_ends(const Anatomy& anatomy);

}  // namespace ecorche::inline v1
