// What lies inside a skin goes along when the skin changes a little: bones and muscles follow a slider at once, without being fitted anew.
//
// Each inner point is a fixed combination of skin points around it, by moving least squares with weights that fall with the fourth power of
// the distance (Schaefer, McPhail and Warren 2006): any affine change of the skin carries the inside exactly, others smoothly.
#pragma once

#include <vector>

#include "anatomy/types.h"

namespace ecorche {

struct Carrier {
  static constexpr int kAnchors = 24;  // skin points an inner point hangs on
  std::vector<int> vertices;           // kAnchors an inner point
  std::vector<float> weights;          // as many; those of a point sum to 1
};

// Skin points are taken no closer than some 20 mm to each other. Throws std::invalid_argument for a skin of fewer than kAnchors such points.
Carrier make_carrier(const Points& skin, const Points& inside);

// Where the inner points are in the changed skin. `out` is resized once and then reused.
void carry(const Carrier& carrier, const Points& changed_skin, Points& out);

}  // namespace ecorche
