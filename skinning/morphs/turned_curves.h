// Curves in the axes in which they matter most. Private to the room.
#pragma once

#include <Eigen/Core>

#include "skinning/morphs/mesh_shapes.h"
#include "skinning/morphs/shape_options.h"

namespace ecorche::inline v1 {

// Orthonormal columns, the first along which the rows of `curves` (#frames x #shapes) reach
// furthest, in the mean square.
Eigen::MatrixXd falling_axes(const Eigen::MatrixXd& curves);

struct DroppedShapes {
  int kept = 0;
  double max_error = 0;     // m, of any vertex in any frame
  double square_error = 0;  // m^2, sum over vertices and frames
};

// What leaving away all shapes but the first ones would leave.
DroppedShapes measure_dropped(const MeshShapes& shapes, int kept);

// Drops the last shapes: all beyond the most, and more as far as the errors allow it. Normals stay
// as they are.
DroppedShapes drop_shapes(MeshShapes& shapes, const ShapeOptions& options);

// Brings curves to 0 .. 1, and shapes and normals accordingly. What they stand at least becomes one
// more shape, at 1 in every frame.
void scale_curves(MeshShapes& shapes);

}  // namespace ecorche::inline v1
