// Whether a registration is sure, doubtful or none.
#pragma once

#include <vector>

#include "morph/registration/articulated_body.h"
#include "morph/registration/articulated_fit.h"
#include "morph/registration/point_tree.h"
#include "morph/registration/registration.h"
#include "morph/registration/scan.h"

namespace ecorche::inline v1 {

// The body as it was before its surface went to the scan's, and the scan as even points.
struct RegistrationEvidence {
  const ArticulatedBody& body;
  const Scan& scan;
  const ScanTarget& target;  // even points, m, file's axes
  const PointTree& tree;     // of them
  const Points& start;       // #skin x 3, scan's frame
  const Points& fitted;      // #skin x 3, the surface after
  const std::vector<PlaceHint>& hints;
};

// Fills the report's distances and doubts. Precondition: doubt and shape_distance are set. Throws
// UnfitError for what is no person, or too little of one.
void judge_registration(const RegistrationEvidence& evidence, Registration& registration);

}  // namespace ecorche::inline v1
