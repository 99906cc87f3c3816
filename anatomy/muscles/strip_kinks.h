// How far a strip's line of centres turns aside and back: what is smooth on its surface, and yet no
// muscle.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"

namespace ecorche::inline v1 {

inline constexpr double kKinkReach = 0.03;  // m, of a chord to both sides

// From the chord over the strip's part about each section to its centre, m, square to the chord;
// nought nearer to the strip's ends than `reach` (m). The part is measured along the action line:
// along the centres a kink would hide itself. `slices`: the strip's.
std::vector<Vec3> off_chords(const Strip& strip, std::span<const Ellipse> slices, double reach);

// By how much each section lies farther off its chord than that of the reference made as long, m;
// not above 0 where it does not. Precondition: as many sections.
std::vector<double> kinks_beyond(const Strip& strip, std::span<const Ellipse> slices,
                                 const Strip& reference);

}  // namespace ecorche::inline v1
