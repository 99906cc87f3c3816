// Slits between muscles: what an eye that looks in from outside sees into.
//
// The underside of the layer of fat is looked at point by point, some millimetres apart. A slit is
// there where a ray straight in meets neither muscle nor bone within 10 mm, though one lies within
// 8 mm beside the point: gaps of up to 16 mm between two that are close to the layer. Wider voids
// are none, nor are grooves that have a floor.
#pragma once

#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// m^2, by the triangle of `flesh` that each point of a slit is nearest to. `skin`: closed. `layer`:
// its thickness, #vertices, m. `looked_at`: #vertices; triangles with all three are. `flesh`:
// muscles and bones, each closed.
std::vector<double> slit_areas(const TriMesh& skin, const std::vector<float>& layer,
                               const std::vector<char>& looked_at, const TriMesh& flesh);

}  // namespace ecorche::inline v1
