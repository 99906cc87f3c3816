// Lengths by which tissue may swell along its normals, for volume_preservation.h. Private to the
// room.
//
// A point of the skin that moves by s along its normal changes an edge by s times the edge's
// curvature. Where a small thing sits on deep tissue, as a nipple on a breast or a nail on a
// finger, the tissue beneath would let it swell by many times its own size. So s goes no further
// than the sharpest bend of the edges about it, and falls gently towards such places. Both hold at
// rest, where they are found: a frame does not compute them.
#pragma once

#include <span>
#include <vector>

namespace ecorche::inline v1 {

// m a unit, #V. `positions`: #V x 4, rest; `triangles`: 3 indices each; `tissue`: between skin
// and bone, m, #V.
std::vector<double> find_swelling_limits(std::span<const float> positions,
                                         std::span<const int> triangles,
                                         std::span<const double> tissue);

}  // namespace ecorche::inline v1
