// A scene of the Open Asset Import Library as a GLB, for ecorche-import alone.
#pragma once

#include <string>

struct aiScene;

namespace ecorche::inline v1 {

// What the scene's coordinates are in.
struct SceneFrame {
  double unit = 1;                                        // m, of one of them
  std::string up = "+Y";                                  // as the file says, for people
  double turn[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  // rows: x, y (up), z of the scene
  double source_unit = 1;                                 // m, that the file states
  std::string format;
};

// Nodes, meshes (a node's meshes are primitives of one), skins with up to 8 joints a vertex, morph
// targets, animations as sampled translations, rotations and scales, textures that the file holds;
// in metres, +Y up. The scene's scale goes into lengths, its axes into its root. Throws
// std::runtime_error with words for people.
std::string scene_glb(const aiScene& scene, const SceneFrame& frame);

}  // namespace ecorche::inline v1
