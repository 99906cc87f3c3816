// What a bake is solved on: frames of the exact skin. Private to the room.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "anatomy/skeleton.h"
#include "skinning/bind.h"

namespace ecorche {

using Rows3f = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Rows9f = Eigen::Matrix<float, Eigen::Dynamic, 9, Eigen::RowMajor>;

struct BakeFrame {
  std::vector<Transform> bones;  // maps of rest points by each joint, then by each helper
  Rows3f exact, normals;         // #V x 3
};

inline Eigen::Affine3d blended(const std::array<Influence, 4>& influences, std::span<const Transform> bones) {
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  for (const Influence& influence : influences)
    if (influence.weight > 0) sum += influence.weight * bones[static_cast<std::size_t>(influence.joint)].matrix();
  return Eigen::Affine3d(sum);
}

}  // namespace ecorche
