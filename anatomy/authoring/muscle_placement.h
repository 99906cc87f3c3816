// Muscles of the table placed on the source skeleton.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/authoring/muscle_table.h"

namespace ecorche::inline v1 {

struct PlaceOptions {
  Sex sex = Sex::male;
  int min_slices = 12;  // a strip; longer paths get more
  int max_slices = 24;
};

// Left and right muscles on the source skeleton: each left one followed by its mirror image. Strips
// have their slices spread so that bends and bellies get most, and the muscle's tubes together have
// the table's volume: bellies are scaled for it, tendons keep their sections; sheets change in
// thickness only. Throws InputError when a landmark's bone or a blend's joint is not in the
// skeleton.
std::vector<Muscle> place_muscles(const MuscleTable& table, const Anatomy& source,
                                  const PlaceOptions& options = {});

}  // namespace ecorche::inline v1
