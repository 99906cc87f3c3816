// Foot slide and ground penetration of a motion.
#pragma once

#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/constraints/motion_report.h"

namespace ecorche::inline v1 {

struct FootMeasures {
  double slide_p95 = 0;    // of the contacts' slides, m
  double penetration = 0;  // deepest point of a sole below the ground, m
};

// Measures the motion as it is, and sets the slide of each contact.
FootMeasures measure_feet(const Skeleton& skeleton, double sole_height, const Motion& motion,
                          std::vector<Contact>& contacts);

}  // namespace ecorche::inline v1
