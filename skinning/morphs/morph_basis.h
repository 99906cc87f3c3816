// The shapes of a mesh, found while the frames of a motion stream by.
//
// What a frame leaves over the shapes so far becomes one more where it is large anywhere
// (Gram-Schmidt). At last a singular value decomposition of the curves turns the shapes so that the
// first ones carry most, and the others are dropped as far as every vertex of every frame allows
// it. (Incremental singular value decomposition after Brand 2002, 10.1007/3-540-47969-4_47.)
#pragma once

#include <vector>

#include <Eigen/Core>

#include "skinning/morphs/mesh_shapes.h"
#include "skinning/morphs/shape_options.h"

namespace ecorche::inline v1 {

class MorphBasis {
 public:
  explicit MorphBasis(Eigen::Index vertices, const ShapeOptions& options = {});

  // The next frame. Offsets and changes of normals: 3 #V; every frame has normals or none has.
  void add(const Eigen::VectorXf& offsets, const Eigen::VectorXf& normals = {});

  // The basis is spent.
  MeshShapes finish();

 private:
  void grow(const Eigen::VectorXf& left);
  void condense();
  Eigen::MatrixXd gathered() const;

  ShapeOptions options_;
  int count_ = 0;                        // shapes
  Eigen::MatrixXf basis_;                // 3 #V x capacity, orthonormal, the first count_ in use
  Eigen::MatrixXf turns_;                // 3 #V x capacity, sum over frames of normals times curves
  std::vector<Eigen::VectorXf> curves_;  // a frame; zero beyond their ends
  Eigen::VectorXf left_;
  double max_left_ = 0, square_left_ = 0;
};

}  // namespace ecorche::inline v1
