// A deformed skin: what one frame writes and the viewer, the exporters and the measurements read.
#pragma once

#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Four floats a vertex (x y z 1 and nx ny nz 0), world, metres, in the vertex order of the skin
// that was bound. Buffers are sized on first use and then reused.
struct SkinFrame {
  std::vector<float> positions;  // #V x 4
  std::vector<float> normals;    // #V x 4, unit length
};

// Positions and unit normals, one row a vertex, as a frame.
void to_frame(const Points& positions, const Points& normals, SkinFrame& out);

// Positions of a frame as doubles. `out` is resized once and then reused.
void to_points(const SkinFrame& frame, Points& out);

}  // namespace ecorche::inline v1
