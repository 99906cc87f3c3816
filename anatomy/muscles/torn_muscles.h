// Whether muscles at rest are as whole as those they were made from: what an eye would call torn.
//
// A template's muscles in another body have other places and sizes, but the same surface, point for
// point. Where points stand out that do not in the template, room was shared out that is not there.
// Creases say nothing here: of two packings of the same muscles, 5 to 6 % of the edges turn by 45
// degrees more or less wherever one looks. `skinning/checks/wholeness.h` compares poses with rest.
#pragma once

#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

// Of one muscle, against the same muscle of the reference.
struct MuscleTear {
  bool known = false;  // the reference has it, strip for strip and slice for slice
  int needles = 0;     // points that stand off the mean of their neighbours by 8 mm more
  int raised = 0;      // points that do so along the surface's normal
  double needle = 0;   // m, by which the worst of these does
  // m, by which a strip's line of centres lies off the chord over 3 cm to both sides, at the worst
  // more than that of the reference made as long: a line that turns aside and back
  double kink = 0;
};

// One a muscle. Muscles are matched by name. A muscle that is larger as a whole is compared with
// the reference made as large.
std::vector<MuscleTear> measure_tears(const std::vector<Muscle>& muscles,
                                      const std::vector<Muscle>& reference);

// Whether it shows: twenty points that stand out of the surface, the worst by 15 mm and more, or
// three, the worst by 25 mm and more; or a strip that turns aside and back by 20 mm and more.
bool is_torn(const MuscleTear& tear);

// Indices of those that are torn, the worst first.
std::vector<int> torn_muscles(const std::vector<MuscleTear>& tears);

}  // namespace ecorche::inline v1
