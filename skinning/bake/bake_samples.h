// Sample frames of a bake, shared by its parts. Private to the room.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/skeleton.h"
#include "skinning/bake/baked_rig.h"
#include "skinning/binding.h"

namespace ecorche::inline v1 {

using Rows3f = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Rows9f = Eigen::Matrix<float, Eigen::Dynamic, 9, Eigen::RowMajor>;
using Influences = std::span<const std::array<Influence, 4>>;

// One frame of the exact skin and of the bones that are to follow it.
struct BakeFrame {
  std::vector<Transform> bones;  // maps of rest points by each joint, then by each helper
  Rows3f exact, normals;         // #V x 3
};

// The inputs that are common to all frames.
struct BakeScene {
  const TriMesh& skin;
  const Skeleton& skeleton;
  const Influences start;  // #V, by joints alone
  const BakeOptions& options;
  const std::vector<Vec3> origins = rest_positions(skeleton);  // of the joints
  const Points normals = vertex_normals(skin);                 // at rest, #V x 3

  std::size_t joints() const { return skeleton.joints.size(); }
  Vec3 place(std::size_t vertex) const { return skin.V.row(vertex); }
};

// Maps of rest points from world frames.
std::vector<Transform> rest_to_pose(const std::vector<Vec3>& origins,
                                    std::span<const Transform> X_WJ);

inline Eigen::Affine3d blended(const std::array<Influence, 4>& influences,
                               std::span<const Transform> bones) {
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  for (const Influence& influence : influences)
    if (influence.weight > 0) sum += influence.weight * bones[influence.joint].matrix();
  return Eigen::Affine3d(sum);
}

}  // namespace ecorche::inline v1
