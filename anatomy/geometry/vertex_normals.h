// Area-weighted vertex normals of a deformed skin.
#pragma once

#include <span>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// positions, normals: 4 floats a vertex. triangles: 3 indices each. Vertices of no triangle get a
// zero normal.
void vertex_normals(std::span<const float> positions, std::span<const int> triangles,
                    std::span<float> normals);

// The same on two threads, to rounding: triangles are summed in two halves, which do not depend on
// the number of threads. `half`: memory, sized at first use. Same input, same bytes.
void vertex_normals(std::span<const float> positions, std::span<const int> triangles,
                    std::span<float> normals, std::vector<float>& half);

}  // namespace ecorche::inline v1
