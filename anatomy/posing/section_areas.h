// Areas of the pieces of four strips at once: lane by lane those of piece_areas, to rounding. Sums
// run over directions, not over lanes; terms of one outline alone are computed once for the two
// pieces that it bounds. Private to posing.
#pragma once

#include <array>

#include "anatomy/posing/posing_data.h"

namespace ecorche::inline v1 {

// The outlines of a row of four strips.
struct LaneOutlines {
  std::array<Double4, kOutlinePoints> at;   // factors
  std::array<Double4, kOutlinePoints> fan;  // times the sum of the two beside them
  Double4 own;                              // areas over those of the ellipses

  void set(const std::array<const SliceOutline*, kLanes>& outlines);
};

PosingAreas areas_between(const LaneOutlines& first, const LaneOutlines& second);

}  // namespace ecorche::inline v1
