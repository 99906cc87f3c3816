// The skin as an elastic sheet that hangs on where the binding has put it. Private to the room.
//
// The sheet's shape minimises, over the places x of its vertices,
//   sum_i w_i |x_i - t_i|^2 + sum_ij c_ij |(x_i - x_j) - (R_i + R_j)/2 (X_i - X_j)|^2
// with cotangent weights c, rest places X and the rotation R_i that fits the edges about vertex i
// best (Sorkine & Alexa 2007, 10.2312/SGP/SGP07/109-116). The anchors t are the binding's places;
// over loose tissue the skin may glide along them up to a length of its own. Rotations and places
// are found in turn; the matrix of the places is constant and factored once (Bouaziz et al. 2014,
// 10.1145/2601097.2601116). Every frame begins at its anchors: the shape is a function of the pose
// alone. What is solved for is the distance from the anchors, so that a skin at rest stays at rest
// to rounding.
#pragma once

#include <span>
#include <vector>

#include "anatomy/types.h"
#include "skinning/settle/settle_workspace.h"
#include "skinning/settle/sparse_solver.h"

namespace ecorche {

// Vertices are worked on eight at a time (simd_lanes.h): what belongs to eight of them lies
// component by component, x x x x x x x x y y y y y y y y. The last eight are made up with vertices
// that nothing is read of.
struct Membrane {
  int vertex_count = 0;
  std::vector<int> first;  // #V + 1 into neighbour
  std::vector<int> neighbour;
  // #eights + 1 into slot, slot_edge: as many slots as the busiest of eight vertices has neighbours
  std::vector<int> slot_begin;
  std::vector<int> slot;         // 8 a slot: a vertex's neighbour, or itself where it has no more
  std::vector<float> slot_edge;  // 32 a slot: c (X_i - X_j), c
  // 24 an eight: rest, times half the sum of c |X_i - X_j|^2: makes the fit of a flat ring definite
  std::vector<float> normal;
  std::vector<float>
      frame;  // 72 an eight: columns of the transposed frame of normal and first edge
  std::vector<float> edges;        // 24 an eight: sum of c (X_i - X_j)
  std::vector<float> hold, glide;  // 8 an eight: w_i; m
  std::vector<int> guide;          // #V: vertex at the end of the first edge
  SheetFactor factor;              // of W + C
};

// `tissue`: what lies between skin and bone, or what it is as loose as lying over, m, #V: skin
// holds the less and glides the further the more there is. Precondition: the mesh has no vertex
// without triangles whose place matters: such a vertex stays on its anchor.
Membrane make_membrane(const TriMesh& skin, std::span<const double> tissue);

// Places that the sheet takes above anchors (#V x 4, x y z 1), as offsets from them (#V x 4, last
// 0): scratch.offsets. Rounds go farther than their own way, so that few do (successive
// over-relaxation). `triangles`: 3 indices each. Allocates only when scratch changes size; same
// input, same bytes at any number of threads.
void relax_membrane(const Membrane& membrane, std::span<const float> anchors,
                    std::span<const int> triangles, int rounds, MembraneScratch& scratch);

}  // namespace ecorche
