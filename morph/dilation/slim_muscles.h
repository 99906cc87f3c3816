// Muscles that have less volume than the room they fill; the rest is fat between them and inside
// their sheaths.
//
// Muscles are grown until they fill the room under the layer of fat (pack_muscles.h), however much
// of it is muscle in that person. Where that is more than they should hold together, bellies are
// made slimmer, those most that were filled furthest beyond their own volume; tendons stay. A
// section of a superficial muscle shrinks about a point near its outer side, to which the skin is
// nearest: what is missing is missing below it, and nothing leaves the room it had. The superficial
// muscles of the belly's wall are made slimmer to their own volume in any case: their room goes on
// behind them, where bowels and fat are that are not drawn.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/queries/ray_caster.h"

namespace ecorche::inline v1 {

// `slices`: the sections of all muscles in order, as the strips hold them; the strips stay.
// `wanted`: #muscles, volumes in proportion to which the total is shared out. `partners`: as for
// pack_muscles. `total`: of all muscles, m^3. `skin`: about them. Nothing but the belly's wall is
// changed where they hold no more. Returns what they hold then, m^3.
double slim_muscles(const std::vector<Muscle>& muscles, std::span<Ellipse> slices,
                    std::span<const double> wanted, std::span<const int> partners, double total,
                    const SkinRays& skin);

}  // namespace ecorche::inline v1
