// Offsets of a mesh over a motion as shapes times curves: morph targets of a file.
#pragma once

#include <Eigen/Core>

namespace ecorche::inline v1 {

// Frame f has vertex i at  sum_k w_k T_k(f) (X(i) + sum_m curves(f, m) shapes(i, m)).
struct MeshShapes {
  // 3 #V x #shapes, m, of the rest pose: x, y, z vertex after vertex
  Eigen::MatrixXf shapes;
  Eigen::MatrixXf normals;  // like the shapes, added to the unit normals; or none
  Eigen::MatrixXf curves;   // #frames x #shapes, 0 .. 1: Blender clamps weights below
  // of any vertex in any frame, and over all of them, m, in the rest pose: blending joints only
  // brings vertices closer
  double max_error = 0, rms_error = 0;
};

}  // namespace ecorche::inline v1
