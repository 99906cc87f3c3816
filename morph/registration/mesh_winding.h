// Which side of a scan's faces is outside, and which faces lie inside of others.
#pragma once

#include <vector>

#include "morph/registration/scan.h"

namespace ecorche::inline v1 {

struct WindingReport {
  int turned = 0;           // faces wound the other way
  bool inside_out = false;  // most of the area was
};

// Winds neighbouring faces alike, then each connected piece so that the side from which more of
// the surroundings is seen is outside (rays); sheets seen from both sides stay. Updates F, normals
// and areas. Precondition: faces.
WindingReport wind_outwards(Scan& scan);

// 0: a point from which at most 1 of 24 rays on its outside leaves the mesh: the inner skin of a
// thick shell. All stay where that is under 15 % of the surface: mouths and eye sockets. Coverings
// hide no body. Precondition: faces, wound.
std::vector<char> without_insides(const Scan& scan);

}  // namespace ecorche::inline v1
