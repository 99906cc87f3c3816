// The skin as an elastic membrane that relaxes from the places where the blend has put it. Private
// to the library.
//
// The relaxed shape minimises, over the places x of its vertices,
//   sum_i w_i |x_i - t_i|^2 + sum_ij c_ij |(x_i - x_j) - (R_i + R_j)/2 (X_i - X_j)|^2
// with cotangent weights c, rest places X and the rotation R_i that fits the edges about vertex i
// best (Sorkine & Alexa 2007, 10.2312/SGP/SGP07/109-116). The anchors t are the blended places;
// over loose tissue the skin may slip along them up to a length of its own. Rotations and places
// are found in turn; the matrix of the places is constant and factored once (Bouaziz et al. 2014,
// 10.1145/2601097.2601116). Every frame begins at its anchors: the shape is a function of the pose
// alone. The unknowns are the distances from the anchors, so that a skin at rest stays at rest to
// rounding.
#pragma once

#include <span>
#include <vector>

#include "anatomy/types.h"
#include "skinning/settle/settle_workspace.h"
#include "skinning/settle/sparse_solver.h"

namespace ecorche::inline v1 {

struct MembraneParameters {
  // Bounds of cotangent weights. A wider range lets slivers of triangles stiffen or tear the
  // membrane.
  double least_cotan = 0.05, most_cotan = 5;
  // Anchor stiffness w over no tissue, beside cotangents of about 0.6, its least value, and the
  // thickness of tissue (m) that halves it. Stiffer: stretch stays where the blend made it; softer:
  // a bend crumples skin far from it.
  double stiffness = 0.7, least_stiffness = 0.1, half_depth = 0.012;
  // Slip along the anchors as a fraction of the tissue's thickness, and its bound, m.
  double slip_fraction = 0.25, most_slip = 0.012;
  int rounds = 2;  // of rotations and places
  // Newton steps of the rotations in the first round and in later ones.
  int first_rotation_steps = 4, rotation_steps = 2;
  // Over-relaxation of a round: two rounds come about as far as three without it.
  float over_relaxation = 1.3f;
};

// Vertices are processed eight at a time (simd_lanes.h): values of eight vertices are stored
// component by component, x x x x x x x x y y y y y y y y. The last eight are padded with vertices
// that nothing reads.
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
  // 72 an eight: columns of the transposed frame of normal and first edge
  std::vector<float> frame;
  std::vector<float> edges;      // 24 an eight: sum of c (X_i - X_j)
  std::vector<float> stiffness;  // 8 an eight: w_i
  std::vector<float> slip;       // 8 an eight: m
  std::vector<int> guide;        // #V: vertex at the end of the first edge
  SupernodalFactor factor;       // of W + C
};

// `looseness`: thickness of the tissue between skin and bone, or the thickness that lets skin move
// as freely, m, #V: skin over more of it is held less and slips further. Precondition: the mesh has
// no vertex without triangles whose place matters: such a vertex stays on its anchor.
Membrane make_membrane(const TriMesh& skin, std::span<const double> looseness);

// Moves `positions` (#V x 4, x y z 1) from their anchors to the relaxed shape. `triangles`: 3
// indices each. Allocates only when the workspace changes size; same input, same bytes at any
// number of threads.
void relax_membrane(const Membrane& membrane, std::span<const int> triangles,
                    std::span<float> positions, MembraneWorkspace& workspace);

}  // namespace ecorche::inline v1
