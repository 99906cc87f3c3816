// Finer skins: a smooth refinement of a triangle mesh as a fixed linear map, so that shapes,
// weights and motion follow it.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// fine = map * base for the positions of any shape of the base mesh. Rows of `map` sum to 1.
struct Refinement {
  Eigen::SparseMatrix<double, Eigen::RowMajor> map;  // #fine x #base
  Triangles F;                                       // on the fine vertices
  std::vector<int> parents;                          // base triangle that each fine one lies in
  std::vector<int> base_rows;                        // fine vertex of each base vertex
};

// Two steps of root-3 subdivision (Kobbelt 2000) a round: nine triangles for one, base edges cut in
// three; 13,380 vertices become 120,404. The scheme alone shrinks what is thin; the base mesh is
// first moved out by half of what the scheme takes away, which keeps the volume of a body to 0.1 %.
// Vertices on a boundary stay where they are. Throws UnfitError where the mesh is no manifold.
// Precondition: rounds >= 0; F indexes vertex_count vertices.
Refinement refine(const Triangles& F, int vertex_count, int rounds = 1);

// Positions of the fine vertices. Precondition: base has #base rows.
Points refine_points(const Refinement& refinement, const Points& base);

}  // namespace ecorche::inline v1
