// Areas of the pieces of four strips at once: lane by lane what piece_areas gives, to rounding. The
// sums run over the directions, not over lanes, and what is one outline's own is found once for the
// two pieces that it ends. Private to posing.
#pragma once

#include <array>

#include "anatomy/posing/posing_table.h"

namespace ecorche {

// The outlines of a row of four strips.
struct LaneOutlines {
  std::array<Lane, kOutlinePoints> at;   // factors
  std::array<Lane, kOutlinePoints> fan;  // times the sum of the two beside them
  Lane own;                              // areas over those of the ellipses

  void set(const std::array<const SliceOutline*, kLanes>& outlines);
};

PosingAreas areas_between(const LaneOutlines& first, const LaneOutlines& second);

}  // namespace ecorche
