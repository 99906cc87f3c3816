// A character's own skin: any mesh, of one piece or many, hung on the base mesh that its body was
// registered with.
#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <string>

#include "anatomy/skeleton.h"
#include "anatomy/types.h"

namespace ecorche::inline v1 {

// What the character's body.skin, the own mesh in the skeleton's rest pose, is hung on and came
// from. Its vertices are those of the source's pieces, one after another (skinning/rigs/).
struct OwnSkin {
  TriMesh base;  // of the same person at rest
  // #skin x #base: own vertices by base vertices; rows sum to 1. Weights, muscle handles and
  // displacements are blended by it.
  Eigen::SparseMatrix<double, Eigen::RowMajor> map;
  Pose pose;  // of the skeleton, in which the source stands
  // World of the standing source, m: x = scale * axes * source + shift.
  double scale = 1;
  Mat3 axes = Mat3::Identity();
  Vec3 shift = Vec3::Zero();
  std::shared_ptr<const std::string> source;  // .glb as it came in, byte for byte
};

}  // namespace ecorche::inline v1
