// Private to the readers of glTF: the node tree of a file.
#pragma once

#include <cstddef>
#include <vector>

#include "anatomy/mesh_files/gltf_file.h"
#include "anatomy/types.h"

namespace ecorche::inline v1 {

// Translation, rotation and scale of a node; a matrix without shear is taken apart into them.
struct NodePlace {
  Vec3 translation = Vec3::Zero();
  Quat rotation = Quat::Identity();
  Vec3 scale = Vec3::Ones();

  Affine map() const {
    return Eigen::Translation3d(translation) * rotation * Eigen::Scaling(scale);
  }
};

// Throws InputError for numbers that are none, as GltfFile.
NodePlace node_place(const GltfFile& file, std::size_t node);
// The node's own map; a matrix as it is.
Affine node_map(const GltfFile& file, std::size_t node);

class GltfTree {
 public:
  explicit GltfTree(const GltfFile& file);

  const std::vector<int>& parents() const { return parents_; }
  const std::vector<std::size_t>& order() const { return order_; }  // parents before children
  const std::vector<Affine>& world() const { return world_; }       // as the file stands
  // Nodes of the default scene, ascending; all where there is none.
  const std::vector<std::size_t>& in_scene() const { return in_scene_; }

 private:
  std::vector<int> parents_;
  std::vector<std::size_t> order_, in_scene_;
  std::vector<Affine> world_;
};

}  // namespace ecorche::inline v1
