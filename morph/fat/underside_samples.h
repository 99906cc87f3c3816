// Points of the underside of the layer of fat, spread evenly over it.
#pragma once

#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct UndersideSample {
  Vec3 point = Vec3::Zero(), inwards = Vec3::Zero();  // inwards: unit
  double area = 0, layer = 0;                         // m^2 that it stands for, m above it
  int triangle = 0;                                   // of the skin
};

// About `spacing` metres apart. `skin`: closed. `layer`: its thickness, #vertices, m. `looked_at`:
// #vertices; triangles with all three are.
std::vector<UndersideSample> underside_samples(const TriMesh& skin, const std::vector<float>& layer,
                                               const std::vector<char>& looked_at, double spacing);

}  // namespace ecorche::inline v1
